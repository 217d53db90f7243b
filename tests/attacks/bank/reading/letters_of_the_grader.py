# family = "reading"
# tries = "The requests with which the grader runs the cells are read whole: who sends them, from which session, with which metadata; and the kernel's own connection file and arguments."
# could_earn = "The instructor's login, the class's path, the points and names of other cells."
# undefended = "LEAK: without a box, the kernel's arguments name a folder below the class."

# %% extra
import getpass
import json
import os
import socket
import sys

kernel = get_ipython().kernel
told = ("<<class>>", "<<home>>", "planted" + "-", "honest_" + "ada", "honest_" + "ben", "canary" + "-of")
request = {name: part for name, part in kernel.get_parent("shell").items() if name != "content"}  # this cell's own text
letters = {
    "request": json.dumps(request, default=repr),
    "control": json.dumps(kernel.get_parent("control"), default=repr),
    "arguments": " ".join([*sys.orig_argv, *sys.argv]),
    "connection": str(vars(kernel.parent)),
    "folders": " ".join((os.getcwd(), os.path.expanduser("~"), os.environ.get("PWD", ""), os.environ.get("OLDPWD", ""))),
    "names": f"{socket.gethostname()} {getpass.getuser()}",
}
for name, text in letters.items():
    for word in told:
        if word in text:
            print("LEAK:", name, word)
sender = json.loads(letters["request"])["header"]
if sender.get("username") not in ("", "username", None, getpass.getuser()):
    print("LEAK:", sender["username"])
