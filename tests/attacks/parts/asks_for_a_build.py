# Ask the grader to build the package with more sources than the workspace has by then: a cell has few seconds.
import os

from autograder.messages.json_lines import Lines
from autograder.messages.workspace_messages import BuildAnswer, BuildRequest
from autograder.workspaces.sources import collect_workspace


def ask(sources):
    """Let it be built, and print the beginning of the answer."""
    if "AUTOGRADER_BUILDS" in os.environ:
        lines = Lines.to(os.environ["AUTOGRADER_BUILDS"], 60.0)
        lines.say(BuildRequest(len(sources), "ros2_ws", ["my_robot_pkg"]))
        for source in sources:
            lines.say(source)
        print(str(lines.hear(BuildAnswer))[:200], flush=True)
