# family = "socket"
# assignment = "lab_1_1"
# tries = "The sources that the kernel sends for a check of a workspace have paths that lead out of it, up and from the root, the name of a file and of a folder at once, and words that are no text."
# could_earn = "Files of the attacker's wherever the grader may write, such as the grader's own start-up files."
# undefended = "Nothing: paths are checked on both sides before anything is written."

# %% extra
import base64
import sys

from autograder.messages.judge_messages import Sources
from autograder.messages.workspace_messages import Source

check_module = sys.modules["autograder.notebook.checking.check"]
DATA = base64.b64encode(b"attack").decode()


def send_sources(tell, subject):
    for path in (
        "ros2_ws/src/../../../../../../tmp/<<mark>>_up", "/tmp/<<mark>>_root", "ros2_ws/src/a", "ros2_ws/src/a/b",
        "ros2_ws//src", "<<home>>/.<<mark>>", "ros2_ws/src/" + "d/" * 400, "ros2_ws/src/\ud800", "ros2_ws/src/x\ny",
    ):
        tell(Source(path, DATA, True))
    tell(Source(["x"], {"a": 1}, "yes"))
    tell(Sources("../../../..", "\ud800\x00" * 2000))


check_module.send_sources = send_sources
