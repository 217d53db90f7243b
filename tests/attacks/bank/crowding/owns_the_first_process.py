# family = "crowding"
# tries = "The box's first processes are older than its kernel, and may have other limits: their memory is written to through /proc, so that they do what the attacker likes."
# could_earn = "Memory, files and processes without a limit, and the grader's own limits for good."
# undefended = "It was run once without the defence, as an ordinary user, and reached nothing: it has not been seen to succeed."
# boxed_only = true

# %% extra
import os
import resource

own = {name: resource.getrlimit(getattr(resource, name)) for name in ("RLIMIT_NOFILE", "RLIMIT_SIGPENDING", "RLIMIT_FSIZE")}
for name in sorted(os.listdir("/proc")):
    if not name.isdigit() or int(name) == os.getpid():
        continue
    try:
        with open(f"/proc/{name}/mem", "r+b", 0) as memory:
            del memory
        limits = {kind: resource.prlimit(int(name), getattr(resource, kind)) for kind in own}
    except OSError:
        continue
    loose = [kind for kind in own if limits[kind][0] > own[kind][0]]
    if loose:
        print("LEAK: looser limits", open(f"/proc/{name}/comm").read().strip(), loose)
    print(name, open(f"/proc/{name}/cgroup").read())
