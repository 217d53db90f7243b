# family = "socket"
# tries = "check begins its conversation, keeps the connection and returns at once, so that the judge goes on waiting for a subject while the notebook goes on."
# could_earn = "A judge that is still at it when the next check begins, or the grader's own trouble instead of zero points, with another try at every run."
# undefended = "Not checked, as the grader's own trouble, which is tried again at every run."

# %% extra
import json
import os
import socket

kept = []


def check(exercise, subject):
    link = socket.socket(socket.AF_UNIX)
    link.connect(os.environ["AUTOGRADER_JUDGE_SOCKET"])
    kept.append(link)
    link.sendall(json.dumps({"say": "check", "exercise": exercise, "kind": "class"}).encode() + b"\n")
    link.recv(1000)
    link.sendall(b'{"say": "ready"}\n')
    return 10.0
