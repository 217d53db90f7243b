# family = "reading"
# tries = "What the machine says of itself: the kernel's parameters at boot, its log, its keys, names and shells of users, names of other machines, timers, mounts of other boxes."
# could_earn = "Tokens that a cloud hands to a machine at boot, and the names of whoever works there."
# undefended = "LEAK: in 7042be52 the parameters at boot."

# %% extra
import os

for name in ("cmdline", "kmsg", "keys", "key-users", "kcore", "bootconfig", "timer_list", "sched_debug"):
    try:
        with open(f"/proc/{name}", "rb") as file:
            if data := file.read(200):
                print("LEAK:", name, len(data))
    except OSError:
        pass
for name, most in (("/etc/passwd", 1), ("/etc/group", 1), ("/etc/hosts", 1)):
    with open(name) as file:
        if len(lines := file.read().splitlines()) > most:
            print("LEAK:", name, len(lines))
for name in ("/etc/shadow", "/etc/pip.conf", "/etc/machine-id", "/etc/environment", "/etc/profile.d", "/etc/gitconfig", "/run/secrets", "/var/log",
             "/var/lib/systemd/coredump", "/var/mail", "/root" "/.bashrc", "/run/user", "/sys/firmware", "/sys/class/dmi"):
    if os.path.exists(name):
        print("LEAK:", name)
with open("/proc/self/mountinfo") as file:
    for line in file:
        if "<<class>>" in line or "<<home>>" in line:
            print("LEAK:", line)
