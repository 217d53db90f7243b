"""The background executors in a real kernel, with cells run as JupyterLab and as nbclient run them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from .conftest import Notebook

pytestmark = pytest.mark.ros

HEAR_ONE_OF_EACH = """
with spinning(ListenerNode()) as listener:
    texts = set(hear(40, listener))
texts
"""


def test_a_cell_shows_what_its_nodes_log(notebook: Notebook) -> None:
    output = notebook.run("""
class ShyNode(Node):
    def __init__(self):
        super().__init__("shy_node")
        self.said = threading.Event()
        self.create_timer(0.005, self.tick)
    def tick(self):
        self.get_logger().info("hello")
        self.said.set()
with spinning(ShyNode()) as shy:
    shy.said.wait(20)
""")
    assert output.error is None
    assert "[shy_node]: hello" in output.stdout
    assert output.stderr == ""


def test_the_last_log_lines_come_before_the_cell_ends_on_a_busy_machine(notebook: Notebook) -> None:
    """They reach the cell through a thread of the kernel's; here that thread is slow."""
    output = notebook.run("""
import sys
class Chatterbox(Node):
    def __init__(self):
        super().__init__("chatterbox")
        self.done = threading.Event()
        self.create_timer(0.005, self.tick)
    def tick(self):
        if not self.done.is_set():
            self.get_logger().info("famous last words")
            self.done.set()
quick_write = sys.stdout.write
def slow_write(text):
    time.sleep(0.2)
    return quick_write(text)
sys.stdout.write = slow_write
with spinning(Chatterbox()) as chatterbox:
    chatterbox.done.wait(20)
unchanged = sys.stdout.write is slow_write
del sys.stdout.write
unchanged
""")
    assert "[chatterbox]: famous last words" in output.stdout
    assert "\x16" not in output.stdout
    assert output.stderr == ""
    assert output.value == "True"


@pytest.mark.parametrize("ids", [("one", "one"), (None, None)], ids=["JupyterLab", "nbclient"])
def test_a_cell_run_again_replaces_what_it_left(notebook: Notebook, ids: tuple[str | None, ...]) -> None:
    """Without the cell's id it is known by its text."""
    cell = 'background = spin_in_background(TalkerNode(text=f"run {time.monotonic_ns()}"))\nbackground'
    for identity in ids:
        output = notebook.run(cell, identity)
        assert output.value == "talker_node spinning in the background. .stop() ends it."
        assert output.stdout == ""
        assert output.stderr == ""
    assert len(eval(notebook.run(HEAR_ONE_OF_EACH).value or "")) == 1


def test_an_edited_cell_replaces_what_it_left_whatever_the_new_node_is_called(notebook: Notebook) -> None:
    notebook.run('spin_in_background(TalkerNode("old_name", "old"))', "one")
    notebook.run('spin_in_background(TalkerNode("new_name", "new"))', "one")
    assert notebook.run(HEAR_ONE_OF_EACH).value == "{'new'}"
    notebook.run("pass", "one")
    assert notebook.run("Node('observer').get_node_names()").value == "['observer']"


def test_a_class_made_anew_by_the_cell_replaces_the_old_one(notebook: Notebook) -> None:
    cell = """
class Beeper(TalkerNode):
    def __init__(self):
        super().__init__("beeper", {text!r})
spin_in_background(Beeper())
"""
    notebook.run(cell.format(text="old"), "one")
    assert "beeper spinning" in (notebook.run(cell.format(text="new"), "one").value or "")
    assert notebook.run(HEAR_ONE_OF_EACH).value == "{'new'}"


def test_nodes_that_never_span_are_ended_too(notebook: Notebook) -> None:
    """A service of a forgotten node would take requests and never answer them."""
    cell = """
from my_robot_interfaces.srv import AddTwoInts
def add(request, response):
    response.sum = request.a + request.b
    return response
keep = globals().get("keep", [])
server = Node(f"server_{len(keep)}")
server.create_service(AddTwoInts, "add", add)
keep.append(server)
"""
    notebook.run(cell, "one")
    notebook.run(cell, "one")
    output = notebook.run("""
client_node = Node("client")
client = client_node.create_client(AddTwoInts, "add")
client.wait_for_service(20)
with spinning(server, client_node):
    sums = [client.call(AddTwoInts.Request(a=n, b=1), timeout_sec=180).sum for n in range(5)]
sums, Node("observer").get_node_names()
""")
    assert output.value == "([1, 2, 3, 4, 5], ['observer'])", output


def test_a_node_of_another_cell_can_be_spun_again(notebook: Notebook) -> None:
    notebook.run("talker = TalkerNode()", "node")
    for _ in range(2):
        output = notebook.run("background = spin_in_background(talker)", "spin")
        assert output.error is None, output.traceback
    assert notebook.run(HEAR_ONE_OF_EACH).value == "{'hello'}"


def test_a_background_without_nodes_left_ends(notebook: Notebook) -> None:
    notebook.run("talker = TalkerNode()", "node")
    notebook.run("background = spin_in_background(talker)", "spin")
    notebook.run("talker = TalkerNode()", "node")
    assert notebook.run("background.running, background.nodes").value == "(False, ())"


def test_a_node_of_the_same_name_from_another_cell_takes_its_place(notebook: Notebook) -> None:
    notebook.run('first = spin_in_background(TalkerNode(text="first"))', "one")
    output = notebook.run('spin_in_background(TalkerNode(text="second"))', "two")
    assert "A talker_node of an earlier cell was still spinning. It was stopped" in output.stdout
    assert "already registered" not in output.stdout, "stopped before, or rcl ends the logs of both"
    assert notebook.run(HEAR_ONE_OF_EACH).value == "{'second'}"


def test_two_nodes_of_a_name_out_of_one_cell_are_left_alone(notebook: Notebook) -> None:
    output = notebook.run("""
first, second = TalkerNode(text="first"), TalkerNode(text="second")
with spinning(first, second, ListenerNode()) as (_, _, listener):
    texts = set(hear(40, listener))
sorted(texts)
""")
    assert output.value == "['first', 'second']"


def test_what_has_a_name_of_its_own_outlasts_its_cell(notebook: Notebook) -> None:
    cell = 'spin_in_background(TalkerNode("talker_{0}", "{0}"), name="{0}")'
    notebook.run(cell.format("a"), "one")
    notebook.run(cell.format("b"), "one")
    assert notebook.run(HEAR_ONE_OF_EACH).value in ("{'a', 'b'}", "{'b', 'a'}")
    notebook.run('spin_in_background(TalkerNode("talker_c", "c"), name="a")', "two")
    assert notebook.run(HEAR_ONE_OF_EACH).value in ("{'b', 'c'}", "{'c', 'b'}")


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
    assert notebook.run(HEAR_ONE_OF_EACH).value == "{'hello'}"


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


def test_errors_of_a_background_land_in_the_cell_that_runs(notebook: Notebook) -> None:
    notebook.run("""
class Late(TalkerNode):
    go = threading.Event()
    failed = threading.Event()
    def tick(self):
        if self.go.is_set() and not self.failed.is_set():
            self.failed.set()
            raise RuntimeError("too late")
background = spin_in_background(Late())
""")
    output = notebook.run("""
Late.go.set()
while not background.errors:
    time.sleep(0.001)
background.stop()
""")
    assert "RuntimeError" in output.stdout
    assert "too late" in output.stdout


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
