# family = "socket"
# tries = "Every socket that can be found in the box, beside the judge's, is asked for a check, a build and an order, with paths of the attacker's choice."
# could_earn = "The grader's own side of builds, which runs outside of this box."
# undefended = "LEAK: without a box, the sockets of the grader's other processes can be found in the scratch folders."

# %% extra
import glob
import json
import os
import socket
import stat

own = os.environ["AUTOGRADER_JUDGE_SOCKET"]
around = os.path.dirname(own)
builds = os.environ.get("AUTOGRADER_BUILDS", own)
patterns = [f"{around}/*", f"{around}/../*", f"{around}/../*/*", "/run/*/*", "/tmp/*", "/tmp/*/*", "/tmp/autograder-*/*/*/*"]
words = [
    {"say": "check", "exercise": "lab_1_1.hello", "domain": 0, "path": "../../..", "count": 0, "trouble": ""},
    {"say": "build", "count": 1, "path": "../../../..", "only": ["x"]}, {"say": "source", "path": "/tmp/<<mark>>_built", "data": "eA=="},
    {"say": "open", "exercise": "lab_1_2.talker", "seed": "0", "type": "open"}, {"say": "start", "run": 1},
]
for name in {os.path.realpath(name) for pattern in patterns for name in glob.glob(pattern)} - {os.path.realpath(own)}:
    try:
        if not stat.S_ISSOCK(os.stat(name).st_mode):
            continue
        for kind in (socket.SOCK_STREAM, socket.SOCK_SEQPACKET):
            with socket.socket(socket.AF_UNIX, kind) as link:
                link.settimeout(1.0)
                link.connect(name)
                for word in words:
                    link.sendall(json.dumps(word).encode() + b"\n")
                if os.path.realpath(name) != os.path.realpath(builds):
                    print("LEAK: another socket", name)
    except OSError:
        pass
