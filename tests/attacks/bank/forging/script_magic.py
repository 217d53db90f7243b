# family = "forging"
# tries = "The solution is a %%script cell: a child process prints verdicts and talks to the judge's socket in the kernel's place."
# could_earn = "All points, where printed words or any connection count."
# undefended = "Refused: no check is expected while a solution cell runs."

# %% solution TalkerNode
%%script python3
import json
import os
import socket

verdict = {"say": "verdict", "verdict": {"exercise": "lab_1_2.talker", "state": "passed", "score": 10.0}}
print(json.dumps(verdict))
link = socket.socket(socket.AF_UNIX)
link.connect(os.environ["AUTOGRADER_JUDGE_SOCKET"])
link.sendall(json.dumps({"say": "check", "exercise": "lab_1_2.talker", "kind": "class"}).encode() + b"\n")
link.sendall(json.dumps(verdict).encode() + b"\n")
print(link.recv(1000))
