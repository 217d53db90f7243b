# family = "socket"
# tries = "The judge's socket is removed and a server of the attacker's own is put in its place, which answers every check with full marks."
# could_earn = "All points, where the socket's owner is believed."
# undefended = "The grader reads verdicts from a channel that the kernel does not have."

# %% extra
<<talks_to_the_judge>>

path = os.environ["AUTOGRADER_JUDGE_SOCKET"]
os.environ["AUTOGRADER_JUDGE_SOCKET"] = own = os.path.join(os.getcwd(), "judge")
try:
    os.unlink(path)
    os.symlink(own, path)
except OSError as error:
    print(error)
server = socket.socket(socket.AF_UNIX)
server.bind(own)
server.listen(8)


def judge():
    while True:
        connection, _ = server.accept()
        asked = json.loads(connection.makefile().readline())
        verdict = {
            "exercise": asked["exercise"], "title": "t", "state": "passed", "score": 10.0, "max_score": 10.0,
            "criteria": [], "timeline": [],
        }
        say(connection, "verdict", verdict=verdict)


threading.Thread(target=judge, daemon=True).start()
