# family = "reading"
# tries = "/proc is searched for processes that are not the kernel's own: their command lines, folders, open files and memory maps."
# could_earn = "Paths, seeds and open files of grader and judge."
# undefended = "LEAK: command lines and working folders of judge, worker and grader."

# %% extra
import os

for process in filter(str.isdigit, os.listdir("/proc")):
    try:
        words = open(f"/proc/{process}/cmdline").read().split("\0")
        others = {"grade", "autograder.judge", "autograder.grading.running.order_executor", "autograder.judge.controlled_judge"}
        if others & set(words) or "<<class>>" in " ".join(words) + os.readlink(f"/proc/{process}/cwd"):
            print("LEAK:", process, words, os.readlink(f"/proc/{process}/cwd"))
    except OSError:
        pass
