"""A node in the background that somebody else spins: it comes back, or the student is told."""

from __future__ import annotations

import io
import sys
import threading
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from autograder.notebook.nodes.background_nodes import spin_in_background, spinning
from autograder.notebook.nodes.spin_threads import CallbackBrokenOff

if TYPE_CHECKING:
    from collections.abc import Callable

pytestmark = [pytest.mark.ros, pytest.mark.usefixtures("ros")]


@pytest.mark.parametrize("threads", [1, 3])
def test_a_node_comes_back_after_spin_once(
    nodes: Any, threads: int, capfd: pytest.CaptureFixture[str]
) -> None:
    node = nodes.Ticker()
    background = spin_in_background(node, threads=threads)
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0.01)
        node.wait_for_ticks(2)
    background.stop()
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("answered", [True, False])
def test_waiting_for_an_answer_with_rclpys_own_function_works(answered: bool) -> None:
    node = Node("asker")
    if answered:
        node.create_service(AddTwoInts, "add", lambda request, response: response)
    client = node.create_client(AddTwoInts, "add")
    ticked = threading.Event()
    node.create_timer(0.005, ticked.set)
    with spinning(node):
        assert client.wait_for_service(20) if answered else True
        future = client.call_async(AddTwoInts.Request())
        rclpy.spin_until_future_complete(node, future, timeout_sec=180 if answered else 0.05)
        assert future.done() == answered
        ticked.clear()
        assert ticked.wait(20), "the node is deaf after rclpy.spin_until_future_complete()"


def test_rclpy_spin_says_that_it_blocks_and_gives_the_node_back(
    nodes: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    node = nodes.Ticker()
    background = spin_in_background(node)
    interruption = iter([KeyboardInterrupt])
    plain_tick = node.tick

    def interrupted() -> None:
        plain_tick()
        if threading.current_thread() is threading.main_thread():
            raise next(interruption)

    node.create_timer(0.005, interrupted)
    with pytest.raises(KeyboardInterrupt):
        rclpy.spin(node)
    node.wait_for_ticks(3)
    assert background.running
    assert "rclpy.spin() blocks this cell: interrupt the kernel to go on." in capfd.readouterr().out


def test_a_node_given_to_another_executor_is_let_go_and_that_is_said(
    nodes: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    node = nodes.Ticker()
    background = spin_in_background(node)
    other = SingleThreadedExecutor()
    other.add_node(node)
    assert node.executor is other
    assert "ticker was added to another executor" in capfd.readouterr().out
    other.remove_node(node)
    other.shutdown()
    background.stop()


def test_spinning_inside_a_callback_is_explained_before_it_hangs(
    monkeypatch: pytest.MonkeyPatch, count_spin_threads: Callable[[], int], until: Any
) -> None:
    # What pytest captures is cut off at each reading, and what a thread prints just then is lost.
    said = io.StringIO()
    monkeypatch.setattr(sys, "stdout", said)
    node = Node("nested")
    client = node.create_client(AddTwoInts, "nobody_serves_this")
    begun = threading.Event()

    def ask() -> None:
        future = client.call_async(AddTwoInts.Request())
        begun.set()
        rclpy.spin_until_future_complete(node, future)

    node.create_timer(0.005, ask)
    background = spin_in_background(node)
    assert begun.wait(20)
    until(lambda: "A callback of nested calls" in said.getvalue())
    assert "calls rclpy.spin_until_future_complete()" in said.getvalue()
    background.end(grace=20)
    assert count_spin_threads() == 0
    assert not any(isinstance(error.error, CallbackBrokenOff) for error in background.errors)


def test_a_callback_that_only_spins_is_broken_off(count_spin_threads: Callable[[], int]) -> None:
    node = Node("nested")
    begun = threading.Event()

    def tick() -> None:
        timer.cancel()
        begun.set()
        rclpy.spin_once(node)

    timer = node.create_timer(0.005, tick)
    background = spin_in_background(node)
    assert begun.wait(20)
    background.end(grace=0.1)
    assert count_spin_threads() == 0
