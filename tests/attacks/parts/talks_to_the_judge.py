# Open a connection to the judge's socket, and say a word on it as a check does.
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
