# The text of a function that searches all that a process can see for what is planted, and says what it has found.
SEARCHES = r"""
import os
import re

SKIPPED = {"/proc", "/sys", "/usr", "/bin", "/sbin", "/lib", "/lib64", "/dev/pts", "/dev/fd"}
FORM = re.compile(rb"planted-[0-9a-f]{16}")


def search(by):
    count, found = 0, []

    def look(path):
        try:
            if not os.path.isfile(path) or os.path.getsize(path) > 300_000:
                return 0
            with open(path, "rb") as file:
                texts = set(FORM.findall(file.read()))
        except OSError:
            return 0
        found.extend(f"LEAK: {by} {path} {text.decode()}" for text in texts)
        return 1

    for path in <<planted>>:
        if os.path.exists(path):
            found.append(f"LEAK: {by} {path} can be seen")
    for folder, names, files in os.walk("/"):
        names[:] = [] if folder.endswith("site-packages") else [
            name for name in names if os.path.join(folder, name) not in SKIPPED and name not in ("include", "test")
        ]
        count += sum(look(os.path.join(folder, name)) for name in files)
    for process in filter(str.isdigit, os.listdir("/proc")):
        for name in ("environ", "cmdline", "mountinfo"):
            try:
                with open(f"/proc/{process}/{name}", "rb") as file:
                    found.extend(f"LEAK: {by} {name} {text.decode()}" for text in set(FORM.findall(file.read())))
            except OSError:
                pass
    try:
        import reference_solution
        found.append(f"LEAK: {by} imported {reference_solution.__file__}")
    except ImportError:
        pass
    return [f"SEARCHED by {by}: {count // 100} hundred files", *found[:20]]
"""
