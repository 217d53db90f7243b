"""An interrupt of the kernel ends a cell in which rclpy waits and nothing arrives; the nodes and ROS live on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.cases import cases

if TYPE_CHECKING:
    from tests.notebook.conftest import Notebook

pytestmark = pytest.mark.ros

BEGIN = cases(__file__, "BEGIN")
AFTERWARDS = """
publisher = node.create_publisher(String, "silence", 10)
publisher.publish(String(data="heard"))
while not node.heard:
    rclpy.spin_once(node)
print(rclpy.ok(), node.heard.pop().data)
"""
WAITS = cases(__file__, "WAITS")


@pytest.mark.parametrize("wait", WAITS)
def test_an_interrupt_ends_a_wait_without_messages(notebook: Notebook, wait: str) -> None:
    assert notebook.run(BEGIN).error is None
    request = notebook.begin(f"threading.Thread(target=say_when_it_waits).start()\n{wait}")
    notebook.wait_for_output("it waits")
    notebook.interrupt()
    # The message in the error is rclpy's own where it handles an interrupt: wait_for_message may return instead.
    assert notebook.result_of(request).error in ("KeyboardInterrupt: ", None)
    assert notebook.run(AFTERWARDS).stdout == "True heard\n"


def test_nodes_in_the_background_spin_on(notebook: Notebook) -> None:
    assert (
        notebook.run(f"{BEGIN}\nlistener = ListenerNode(); spin_in_background(TalkerNode(), listener)").error
        is None
    )
    request = notebook.begin("threading.Thread(target=say_when_it_waits).start()\nrclpy.spin(node)")
    notebook.wait_for_output("it waits")
    notebook.interrupt()
    assert notebook.result_of(request).error == "KeyboardInterrupt: "
    assert notebook.run("print(len(hear(3, listener)))").stdout.endswith("3\n")
