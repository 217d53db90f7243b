"""The picture that follows the running graph, in a kernel; nbclient applies updates as JupyterLab does."""

from __future__ import annotations

import base64
import re
from typing import TYPE_CHECKING, Any

import pytest

from autograder.notebook.observing.graph_picture import watch_graph
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

START = cases(__file__, "START")

pytestmark = pytest.mark.ros


@pytest.fixture
def run(run_cells: Callable[..., list[Any]]) -> Callable[..., list[Any]]:
    """Run cells below START; what each shows in the end."""
    return lambda *sources: run_cells(START, *sources)[1:]


def svg(output: Any) -> str:
    (data,) = re.findall(r"base64,([^\"]+)", output.data["text/html"])
    return base64.b64decode(data).decode()


def test_nodes_come_and_go_in_the_picture(run: Callable[..., list[Any]]) -> None:
    source = """
watch = watch_graph()
node = Node("newcomer")
await_picture(lambda p: "/newcomer" in p.graph.nodes)
node.destroy_node()
pictures.clear()
await_picture(lambda p: not p.graph.nodes)
other = Node("other")
await_picture(lambda p: "/other" in p.graph.nodes)
watch.stop()
print(watch.running)
"""
    (outputs,) = run(source)
    (said,) = (output for output in outputs if output.output_type == "stream")
    (shown,) = (output for output in outputs if output.output_type == "display_data")
    assert "/other" in svg(shown)
    assert "/newcomer" not in svg(shown)
    assert "_graph_watch" not in svg(shown)
    assert said.text == "False\n"


def test_a_topic_with_traffic_has_a_rate_and_its_lines_flow_until_the_watch_ends(
    run: Callable[..., list[Any]],
) -> None:
    source = """
watch = watch_graph()
node = Node("talker")
publisher = node.create_publisher(String, "chatter", 10)
node.create_timer(0.01, lambda: publisher.publish(String(data="x")))
talking = spin_in_background(node)
await_picture(lambda p: p.is_moving)
flowing = next(p for p in pictures if p.is_moving).svg()
print("flows" in flowing.partition("</style>")[2], "/s</text>" in flowing)
watch.stop()
"""
    (outputs,) = run(source)
    (said,) = (output for output in outputs if output.output_type == "stream")
    (shown,) = (output for output in outputs if output.output_type == "display_data")
    assert said.text == "True True\n"
    assert "/chatter" in svg(shown)
    assert "flows" not in svg(shown).partition("</style>")[2], "a picture at rest"


def test_it_ends_with_ros_and_when_everything_is_stopped(run: Callable[..., list[Any]]) -> None:
    *_, said = run(
        "watch = watch_graph()",
        "from autograder.notebook.nodes.background_nodes import stop_all\n"
        "stop_all(); watch._thread.join(); print(watch.running)",
        "watch = watch_graph()",
        "rclpy.shutdown(); watch._thread.join(); print(watch.running)",
    )
    assert said[0].text == "False\n"


def test_a_second_run_of_the_cell_takes_the_place_of_the_first(run: Callable[..., list[Any]]) -> None:
    cell = "watches = [*globals().get('watches', ()), watch_graph()]"
    *_, said = run(cell, cell, "watches[0]._thread.join(); print(watches[0].running, watches[1].running)")
    assert said[0].text == "False True\n"


def test_no_time_at_all_is_an_error() -> None:
    with pytest.raises(ValueError, match="such as 10, not 0"):
        watch_graph(0)
