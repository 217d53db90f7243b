# family = "reading"
# tries = "The names of control groups, mounts, sockets, maps and limits of every process are read for what they say of others: the class's folder, the instructor's home, the other students."
# could_earn = "Who else is in the class, and where its secrets lie."
# undefended = "LEAK: without a box the mounts and maps of the grader's processes name the class."

# %% extra
import os

told = ("<<class>>", "<<home>>", "honest_" + "ada", "honest_" + "ben")
for process in (*filter(str.isdigit, os.listdir("/proc")), "self"):
    for name in ("cgroup", "mountinfo", "maps", "net/unix", "cpuset", "uid_map", "limits", "status", "sched", "comm", "stat", "wchan"):
        try:
            with open(f"/proc/{process}/{name}", errors="replace") as file:
                lines = file.read().splitlines()
        except OSError:
            continue
        for line in lines:
            # Its own folder may say whose it is.
            if any(word in line for word in told):
                print("LEAK:", process, name, line[:150])
for folder, _, files in os.walk("/sys/fs/cgroup"):
    if any(word in folder for word in told):
        print("LEAK:", folder)
