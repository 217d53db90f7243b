"""What a check's context leaves behind when it ends."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytestmark = pytest.mark.ros

LEFT_AND_MADE_AGAIN = """
import rclpy
from autograder.notebook.checking.judge_link import CheckContext

rclpy.init()
with CheckContext(7, "_keeper") as place:
    place.ensure(fresh=True)
    left = rclpy.create_node("client")
rclpy.create_node("client").get_logger().info("after the check")
"""


def test_a_node_that_was_left_does_not_spoil_the_log_of_a_later_one() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LEFT_AND_MADE_AGAIN], capture_output=True, text=True, check=False
    )
    said = done.stdout + done.stderr
    assert "after the check" in said
    assert "rosout" not in said
