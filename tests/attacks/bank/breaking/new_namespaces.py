# family = "breaking"
# tries = "A user namespace of the attacker's own would give it every capability inside: to mount, to make networks, to trace. Then setuid programs, device nodes and other privileges are tried."
# could_earn = "The first half of most ways out of a container."
# boxed_only = true

# %% extra
import ctypes
import os
import subprocess

libc = ctypes.CDLL(None, use_errno=True)
done = []
for name, flag in (("user", 0x10000000), ("mount", 0x20000), ("network", 0x40000000), ("pid", 0x20000000)):
    if libc.unshare(flag) == 0:
        done.append(f"{name} namespace")
for path, mode, device in (("zero", 0o020666, os.makedev(1, 5)), ("sda", 0o060666, os.makedev(8, 0))):
    try:
        os.mknod(path, mode, device)
        open(path, "rb").read(1)
        done.append(f"device {path}")
    except OSError:
        pass
status = open("/proc/self/status").read()
for line in status.splitlines():
    name, _, value = line.partition(":")
    if name in ("CapEff", "CapPrm", "CapBnd", "CapAmb") and int(value, 16):
        done.append(line)
    if name == "NoNewPrivs" and value.strip() != "1":
        done.append(line)
for program in (["su", "-c", "id"], ["sudo", "-n", "id"], ["bwrap", "--dev-bind", "/", "/", "id"], ["unshare", "-Ur", "id"]):
    try:
        if subprocess.run(program, capture_output=True, stdin=subprocess.DEVNULL, timeout=3).returncode == 0:
            done.append(program[0])
    except (OSError, subprocess.TimeoutExpired):
        pass
print("LEAK:" if done else "nothing", done)
