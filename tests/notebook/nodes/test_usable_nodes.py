"""Mistakes with what is to be spun are named exactly."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from autograder.notebook.nodes.background_nodes import spin_in_background, spinning
from autograder.notebook.nodes.node_errors import (
    NodeBusyError,
    NotANodeError,
    SettingError,
    UnusableNodeError,
)
from autograder.notebook.nodes.ros_session import start_ros

if TYPE_CHECKING:
    from collections.abc import Callable

pytestmark = [pytest.mark.ros, pytest.mark.usefixtures("ros")]


class NoSuperInit(Node):
    def __init__(self) -> None:
        self.counter = 0


def make_nothing() -> Any:
    """A function that forgets to return its node."""


@pytest.mark.parametrize(
    ("things", "message"),
    [
        ((NoSuperInit,), r"NoSuperInit is a class\. Add parentheses .*: spinning\(NoSuperInit\(\)\)"),
        ((threading.Thread,), "Thread is a class that is not derived from Node"),
        (([1, 2],), r"one by one, not in a list: .*spinning\(\*nodes\)"),
        ((make_nothing,), r"make_nothing is a function\. Call it"),
        ((make_nothing(),), "must end with `return node`"),
        (("talker",), "this argument is of type str: 'talker'"),
        ((), r"at least one node, such as spinning\(TalkerNode\(\)\)"),
    ],
    ids=["class", "other class", "list", "function", "None", "text", "nothing"],
)
def test_what_is_not_a_node(things: tuple[Any, ...], message: str) -> None:
    with pytest.raises(NotANodeError, match=message):
        spinning(*things)


def test_the_message_names_the_function_that_was_called() -> None:
    with pytest.raises(NotANodeError, match=r"spin_in_background\(NoSuperInit\(\)\)"):
        spin_in_background(NoSuperInit)  # type: ignore[arg-type]


def test_a_node_without_super_init() -> None:
    with pytest.raises(UnusableNodeError, match=r'NoSuperInit.*super\(\).__init__\("a_name"\)'):
        spinning(NoSuperInit())


def test_a_destroyed_node(nodes: Any) -> None:
    node = nodes.Ticker()
    with spinning(node):
        pass
    with pytest.raises(UnusableNodeError, match=r"has been destroyed.*Make a new one: Ticker\(\)"):
        spinning(node)


def test_a_node_of_a_ros_that_was_shut_down(nodes: Any) -> None:
    node = nodes.Ticker()
    rclpy.shutdown()
    start_ros()
    with pytest.raises(UnusableNodeError, match=r"ROS was shut down after this Ticker"):
        spinning(node)


def test_a_node_made_before_ros_is_up(nodes: Any) -> None:
    rclpy.shutdown()
    with pytest.raises(rclpy.exceptions.NotInitializedException) as raised:
        nodes.Ticker()
    assert "call start_ros() before you make a node" in raised.value.__notes__[0]


def test_a_node_that_spins_in_the_background(nodes: Any) -> None:
    node = nodes.Ticker()
    spin_in_background(node)
    with pytest.raises(NodeBusyError, match=r"ticker spins in the background already: .*\.stop\(\)"):
        spinning(node)


def test_a_node_in_an_executor_of_the_students_own(nodes: Any) -> None:
    node = nodes.Ticker()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    with pytest.raises(NodeBusyError, match=r"another executor already \(SingleThreadedExecutor\)"):
        spinning(node)
    executor.remove_node(node)
    executor.shutdown()
    with spinning(node):
        node.wait_for_ticks(1)


def test_the_same_node_twice(nodes: Any) -> None:
    node = nodes.Ticker()
    with pytest.raises(NodeBusyError, match="the same node twice"):
        spinning(node, node)


def test_nodes_of_different_contexts(nodes: Any, graph: Node) -> None:
    with pytest.raises(UnusableNodeError, match="different ROS contexts"):
        spinning(nodes.Ticker(), graph)


def test_a_node_that_got_busy_between_spinning_and_with(nodes: Any) -> None:
    node = nodes.Ticker()
    block = spinning(node)
    spin_in_background(node)
    with pytest.raises(NodeBusyError), block:
        pass
    node.wait_for_ticks(1)


@pytest.mark.parametrize("threads", [0, -1, 1.5, "two", True, None])
def test_impossible_numbers_of_threads(nodes: Any, threads: Any) -> None:
    with pytest.raises(SettingError, match="whole number of at least 1"):
        spinning(nodes.Ticker(), threads=threads)


@pytest.mark.parametrize("name", ["", 7])
def test_impossible_names(nodes: Any, name: Any) -> None:
    with pytest.raises(SettingError, match="name must be a string"):
        spin_in_background(nodes.Ticker(), name=name)


def test_a_refused_node_is_left_as_it_was(nodes: Any, until: Callable[[Any], Any]) -> None:
    node = nodes.Ticker()
    with pytest.raises(NotANodeError):
        spinning(node, "another")  # type: ignore[arg-type]
    with spinning(node):
        node.wait_for_ticks(1)
