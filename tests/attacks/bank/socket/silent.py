# family = "socket"
# tries = "check connects and says nothing, or asks and then answers nothing, until the cell's time is nearly up."
# could_earn = "A judge that waits for ever, and a batch that does not end."
# undefended = "The judge stops waiting; zero points."

# %% extra
import json
import os
import socket
import threading
import time


def connect():
    link = socket.socket(socket.AF_UNIX)
    link.settimeout(5.0)
    link.connect(os.environ["AUTOGRADER_JUDGE_SOCKET"])
    return link


def say(link, word, **rest):
    link.sendall(json.dumps({"say": word, **rest}).encode() + b"\n")


def check(exercise, subject):
    link = connect()
    if exercise == "lab_1_2.talker":
        time.sleep(3.0)
        return 10.0
    say(link, "check", exercise=exercise, kind="class")
    link.recv(1000)
    time.sleep(3.0)
    return 10.0
