"""The end of a kernel: with whatever spins, it exits at once, with code 0 and nothing on standard error."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from jupyter_client.manager import KernelManager

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = pytest.mark.ros

SET_UP = """
import threading, time
import rclpy
from rclpy.node import Node
from my_robot_interfaces.srv import AddTwoInts
from autograder.notebook.nodes.background_nodes import spin_in_background, spinning, stop_all
from autograder.notebook.nodes.ros_session import start_ros
start_ros()
begun = threading.Event()
def make(name, callback):
    node = Node(name)
    node.client = node.create_client(AddTwoInts, "nobody_serves_this")
    node.create_timer(0.001, lambda: (begun.set(), callback(node)))
    return node
def sleep_for_ever(node):
    while True:
        time.sleep(0.01)
"""

LEFT_BEHIND = {
    "a spinning node": "b = spin_in_background(make('a', lambda node: None))",
    "many threads": "b = spin_in_background(make('a', lambda node: time.sleep(0.002)), threads=4)",
    "a background that nobody keeps": "spin_in_background(make('a', lambda node: None))",
    "a callback in an endless loop": "b = spin_in_background(make('a', sleep_for_ever))",
    "a callback in a call nobody answers": (
        "b = spin_in_background(make('a', lambda node: node.client.call(AddTwoInts.Request())))"
    ),
    "a callback that catches everything": """
def stubborn(node):
    while True:
        try:
            time.sleep(0.01)
        except BaseException:
            pass
b = spin_in_background(make('a', stubborn))""",
    "a ROS that was shut down": """
b = spin_in_background(make('a', lambda node: None))
begun.wait(20)
rclpy.shutdown()""",
    "a block that sys.exit() leaves": """
import sys
with spinning(make('a', lambda node: None)):
    begun.wait(20)
    sys.exit()""",
    "a block that was entered by hand": "spinning(make('a', lambda node: None)).__enter__()",
    "an unfinished await": """
async def ask():
    begun.set()
    await node.client.call_async(AddTwoInts.Request())
node = make('a', lambda node: None)
node.create_timer(0.001, ask)
b = spin_in_background(node)""",
    "nothing that ever started": "block = spinning(make('a', lambda node: begun.set())); begun.set()",
}


@pytest.mark.parametrize("left", LEFT_BEHIND.values(), ids=LEFT_BEHIND.keys())
def test_a_process_ends_cleanly(left: str, domain: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", f"{SET_UP}\n{left}\nbegun.wait(20)"],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_kernel_ends_cleanly(domain: int, tmp_path: Path) -> None:
    log = tmp_path / "stderr"
    with log.open("w") as stderr:
        manager = KernelManager(kernel_name="python3")
        manager.start_kernel(env={**os.environ, "ROS_DOMAIN_ID": str(domain)}, stderr=stderr)
        client = manager.blocking_client()
        client.start_channels()
        client.wait_for_ready(timeout=180)
        for cell in (SET_UP, *list(LEFT_BEHIND.values())[:2], "begun.wait(20)"):
            client.execute_interactive(cell, timeout=180, output_hook=lambda message: None)
        client.shutdown(reply=False)
        process = manager.provisioner.process  # type: ignore[union-attr]
        assert process.wait(timeout=180) == 0
        client.stop_channels()
        manager.cleanup_resources()
    # ipykernel's own word about its transport is not ours.
    said = [line for line in log.read_text().splitlines() if "without encryption" not in line]
    assert said == []
