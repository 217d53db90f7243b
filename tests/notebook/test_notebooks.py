"""The background executors in a real kernel, with cells run as JupyterLab and as nbclient run them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest

from tests.cases import cases, named_cases

if TYPE_CHECKING:
    from collections.abc import Callable

    from .conftest import Notebook

pytestmark = pytest.mark.ros

CELLS = cases(__file__, "CELLS")
"""Cells of several cases, by their names."""


@pytest.mark.parametrize("steps", named_cases(__file__, "what_a_cell_leaves_and_shows"))
def test_what_a_cell_leaves_and_shows(notebook: Notebook, steps: tuple[dict[str, Any], ...]) -> None:
    for step in steps:
        output = notebook.run(CELLS.get(step["run"], step["run"]), step.get("cell"))
        assert (output.error, output.stderr) == (None, ""), output.traceback
        assert output.value in step.get("values", (output.value,))
        assert output.stdout == step.get("stdout", output.stdout)
        assert [text for text in step.get("shows", ()) if text not in output.stdout] == []
        assert [text for text in step.get("hides", ()) if text in output.stdout] == []


def test_an_interrupt_ends_the_block_and_leaves_the_background_alone(notebook: Notebook) -> None:
    notebook.run("background = spin_in_background(TalkerNode())", "one")
    request = notebook.begin("""
with spinning(ListenerNode()) as listener:
    print("listening")
    while True:
        time.sleep(60)
""")
    notebook.wait_for_output("listening")
    notebook.interrupt()
    output = notebook.result_of(request)
    assert output.traceback == "Interrupted: listener_node stopped."
    assert output.stderr == ""
    assert notebook.run("background.running, rclpy.ok()").value == "(True, True)"
    assert notebook.run("Node('observer').get_node_names()").value == "['talker_node', 'observer']"
    assert notebook.run(CELLS["hear one of each"]).value == "{'hello'}"


def test_the_arrow_is_at_the_line_that_raised_and_not_at_the_finally_below_it(notebook: Notebook) -> None:
    output = notebook.run("""
def work():
    try:
        int("no number")
    finally:
        print("tidied up")
work()
""")
    assert output.error is not None
    lines = re.sub(r"\x1b\[[\d;]*m", "", output.traceback).splitlines()
    assert [line.split(maxsplit=2)[2] for line in lines if "--> " in line] == ["work()", 'int("no number")']


def test_an_error_in_a_callback_is_a_traceback_of_the_students_lines(notebook: Notebook) -> None:
    output = notebook.run("""
class Broken(TalkerNode):
    def tick(self):
        message = String()
        self.ticked.set()
        message.dta = "typo"
broken = Broken()
broken.ticked = threading.Event()
with spinning(broken):
    broken.ticked.wait(20)
""")
    assert output.stderr == ""
    assert "Error in talker_node, in the callback of its timer (every 0.005 s)" in output.stdout
    assert "Broken.tick" in output.stdout
    assert "site-packages" not in output.stdout
    assert "autograder" not in output.stdout
    assert (output.error or "").startswith("CallbackFailedError: talker_node, in the callback of its timer")
    assert "'String' object has no attribute 'dta'" in (output.error or "")
    assert output.traceback.count("\n") <= 2


def test_a_wrong_argument_shows_the_students_line_only(notebook: Notebook) -> None:
    output = notebook.run("spinning(TalkerNode)")
    assert "Add parentheses to make a node of it: spinning(TalkerNode())" in (output.error or "")
    assert "usable_nodes" not in output.traceback
    assert "----> " in output.traceback


def test_a_notebook_in_ci_stops_at_the_cell_whose_callbacks_fail(run_cells: Callable[..., list[Any]]) -> None:
    set_up = (
        "import threading, time\nfrom rclpy.node import Node\n"
        "from autograder.notebook import spin_in_background, spinning, start_ros"
    )
    broken = """
start_ros()
ticked = threading.Event()
def tick():
    ticked.set()
    raise RuntimeError("no such robot")
node = Node("broken")
node.create_timer(0.005, tick)
with spinning(node):
    ticked.wait(20)
"""
    last = 'spin_in_background(Node("left_spinning"))'
    _, outputs, left = run_cells(set_up, broken, last, allow_errors=True)
    kinds = [(output.output_type, output.get("name")) for output in outputs]
    assert kinds == [("stream", "stdout"), ("error", None)]
    assert "Traceback" in outputs[0].text
    assert outputs[1].ename == "CallbackFailedError"
    assert left[0].data["text/plain"] == "left_spinning spinning in the background. .stop() ends it."
