"""What an earlier run of a check has left is gone for the subject when the next one begins, however late the news."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
import rclpy
from my_robot_interfaces.srv import AddTwoInts

from autograder.notebook import spinning

sys.path.insert(0, str(Path(__file__).parents[1]))
from checked import a_judge

from tests.cases import cases

pytestmark = pytest.mark.ros

LATE_NEWS = cases(__file__, "LATE_NEWS")
"""The judge's services are seen for a second after the judge has taken them away."""


def add(*numbers: int, patience_sec: float = 5.0) -> int:
    """A right client that waits with its limit and then makes blocking calls."""
    node = rclpy.create_node("adder")
    client = node.create_client(AddTwoInts, "add_two_ints")
    try:
        if not client.wait_for_service(timeout_sec=patience_sec):
            raise TimeoutError("add_two_ints is not available")
        total, *others = numbers
        with spinning(node):
            for number in others:
                answer: Any = client.call(AddTwoInts.Request(a=total, b=number))
                total = answer.sum
        node.get_logger().info(f"the sum is {total}")
        return total
    finally:
        node.destroy_node()


def add_two(a: int, b: int, patience_sec: float = 5.0) -> int:
    return add(a, b, patience_sec=patience_sec)


def add_three(a: int, b: int, c: int, patience_sec: float = 5.0) -> int:
    return add(a, b, c, patience_sec=patience_sec)


@pytest.mark.parametrize(
    ("exercise", "function"), [("lab_1_3.client", add_two), ("exercise_1_2.three_ints", add_three)]
)
def test_a_right_client_passes_where_the_news_that_the_service_is_gone_is_late(
    exercise: str, function: Any
) -> None:
    with a_judge(change=LATE_NEWS) as checked:
        verdict = checked(exercise, function)
    assert verdict.passed, [f"{c.name}: {c.seen}" for c in verdict.criteria if not c.passed]
