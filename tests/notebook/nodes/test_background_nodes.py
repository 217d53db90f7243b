"""``spin_in_background``: nodes that spin until they are stopped, whatever happens to them."""

from __future__ import annotations

import gc
import threading
import time
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import Executor, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from autograder.notebook.nodes import spin_threads
from autograder.notebook.nodes.background_nodes import spin_in_background, stop_all
from autograder.notebook.nodes.node_errors import CallbackErrors
from autograder.notebook.nodes.ros_session import (
    NodeEndedError,
    destroy_node,
    is_destroyed,
    release_waiting_calls,
    start_ros,
)
from autograder.notebook.nodes.spin_threads import CallbackBrokenOff, SpinFailure
from tests.notebook.conftest import LIMIT

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.notebook.nodes.background_nodes import Background

pytestmark = [pytest.mark.ros, pytest.mark.usefixtures("ros")]


def test_it_spins_until_it_is_stopped(nodes: Any, count_spin_threads: Callable[[], int]) -> None:
    ticker, listener = nodes.Ticker(), nodes.Listener()
    background = spin_in_background(ticker, listener)
    listener.heard.get(timeout=180)
    assert background.running
    assert repr(background) == "ticker, listener spinning in the background. .stop() ends it."
    background.stop()
    assert not background.running
    assert count_spin_threads() == 0
    assert is_destroyed(ticker)
    assert is_destroyed(listener)
    assert repr(background) == "ticker, listener stopped."
    background.stop()


def test_it_can_end_with_a_block(nodes: Any) -> None:
    with spin_in_background(nodes.Ticker(), name="pulse", threads=2) as background:
        assert repr(background) == "pulse: ticker spinning in the background in 2 threads. .stop() ends it."
    assert not background.running


def test_nothing_of_it_needs_to_be_kept(nodes: Any) -> None:
    """rclpy's nodes hold their executor weakly: one nobody keeps is collected and the node falls silent."""
    node = nodes.Ticker()
    spin_in_background(node)
    gc.collect()
    node.wait_for_ticks(3)


def test_a_name_is_taken_over_and_a_node_given_again_lives_on(nodes: Any) -> None:
    kept, left = nodes.Ticker("kept"), nodes.Ticker("left")
    first = spin_in_background(kept, left, name="pulse")
    second = spin_in_background(kept, name="pulse")
    assert not first.running
    assert is_destroyed(left)
    kept.wait_for_ticks(2)
    assert second.nodes == (kept,)


def test_it_can_be_stopped_from_within_a_callback(until: Any, count_spin_threads: Callable[[], int]) -> None:
    node = Node("suicidal")
    background = spin_in_background(node)
    node.create_timer(0.005, background.stop)
    until(lambda: is_destroyed(node))
    stop_all()
    assert count_spin_threads() == 0
    assert not background.running
    assert background.errors == ()


@pytest.mark.parametrize("threads", [1, 3])
def test_ros_shut_down_under_it_is_said_and_nothing_is_left(
    nodes: Any, threads: int, until: Any, capfd: pytest.CaptureFixture[str], count_spin_threads: Any
) -> None:
    node = nodes.Ticker()
    background = spin_in_background(node, threads=threads)
    node.wait_for_ticks(1)
    rclpy.shutdown()
    until(lambda: count_spin_threads() == 0)
    assert not background.running
    assert is_destroyed(node), "a service of it would still swallow requests"
    printed = capfd.readouterr()
    assert "ROS was shut down, so ticker spins no longer." in printed.out
    assert printed.err == ""
    start_ros()
    again = nodes.Ticker()
    spin_in_background(again)
    again.wait_for_ticks(1)


def test_a_callback_may_end_it_as_it_ends_a_script(
    until: Any, capfd: pytest.CaptureFixture[str], count_spin_threads: Callable[[], int]
) -> None:
    node = Node("done")

    def leave() -> None:
        raise SystemExit

    node.create_timer(0.005, leave)
    background = spin_in_background(node)
    until(lambda: count_spin_threads() == 0)
    assert is_destroyed(node)
    assert background.errors == ()
    assert "A callback raised SystemExit, so done spins no longer." in capfd.readouterr().out


def test_trouble_of_the_executor_is_survived_or_told(
    nodes: Any, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], count_spin_threads: Any
) -> None:
    """rclpy's wait fails for a moment when something is destroyed just then; it must not fail for ever."""
    trouble = threading.Event()
    plain_wait = Executor.wait_for_ready_callbacks

    def wait(executor: Executor, *args: Any, **kwargs: Any) -> Any:
        if trouble.is_set():
            if not lasting:
                trouble.clear()
            raise RuntimeError("wait set is broken")
        return plain_wait(executor, *args, **kwargs)

    monkeypatch.setattr(Executor, "wait_for_ready_callbacks", wait)
    node = nodes.Ticker()
    background = spin_in_background(node)
    lasting = False
    trouble.set()
    node.wait_for_ticks(3)
    assert background.errors == ()
    lasting = True
    trouble.set()
    background._threads._threads[0].join(20)
    assert not background.running
    assert count_spin_threads() == 0
    printed = capfd.readouterr().out
    assert "RuntimeError: wait set is broken" in printed
    assert "The executor failed, so ticker spins no longer." in printed


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize(("own", "seen"), [(None, []), (ValueError("no such robot"), ["its timer"])])
def test_a_node_may_be_destroyed_while_its_callback_runs(
    nodes: Any, own: Exception | None, seen: list[str], threads: int
) -> None:
    begun, destroyed = threading.Event(), threading.Event()

    def tick() -> None:
        begun.set()
        destroyed.wait(LIMIT)
        if own:
            raise own
        doomed.publisher.publish(String())

    doomed, other = nodes.Ticker("doomed"), nodes.Ticker("other")
    doomed.create_timer(0.01, tick)
    background = spin_in_background(doomed, other, threads=threads)
    assert begun.wait(LIMIT)
    doomed.destroy_node()
    destroyed.set()
    other.wait_for_ticks(20)
    assert background.running
    assert [error.where for error in background.errors] == seen


def test_an_error_of_a_timer_that_is_destroyed_is_told(
    nodes: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    ticker = nodes.Ticker()
    timer = ticker.create_timer(60.0, None)
    ticker.destroy_node()
    errors = CallbackErrors()
    errors.record(SpinFailure(TypeError("not callable"), timer, ticker))
    assert [error.where for error in errors.all] == ["its timer"]
    assert "TypeError: not callable" in capsys.readouterr().out


@pytest.mark.parametrize("threads", [1, 3])
def test_a_node_may_be_destroyed_while_it_spins(nodes: Any, threads: int) -> None:
    """In real notebooks ``node.destroy_node()`` stands in the last cell, whatever spins."""
    doomed, other = nodes.Ticker("doomed"), nodes.Ticker("other")
    background = spin_in_background(doomed, other, threads=threads)
    doomed.wait_for_ticks(3)
    doomed.destroy_node()
    other.wait_for_ticks(20)
    assert background.running
    assert background.errors == ()


@pytest.mark.parametrize("threads", [1, 2])
def test_stopping_waits_for_a_running_callback(threads: int) -> None:
    node = Node("busy")
    begun, ended = threading.Event(), threading.Event()

    def work() -> None:
        begun.set()
        time.sleep(0.1)
        ended.set()

    node.create_timer(0.005, work)
    background = spin_in_background(node, threads=threads)
    assert begun.wait(20)
    background.stop()
    assert ended.is_set()
    assert background.errors == ()


@pytest.mark.parametrize("threads", [1, 2])
def test_an_endless_callback_is_broken_off_and_shown_where_it_was(
    threads: int, capfd: pytest.CaptureFixture[str], count_spin_threads: Callable[[], int]
) -> None:
    node = Node("endless")
    begun = threading.Event()

    def loop() -> None:
        while True:
            begun.set()
            time.sleep(0.01)

    node.create_timer(0.005, loop)
    background = spin_in_background(node, threads=threads)
    assert begun.wait(20)
    background.end(grace=0.05)
    assert count_spin_threads() == 0
    assert isinstance(background.errors[0].error, CallbackBrokenOff)
    printed = capfd.readouterr()
    assert "in loop" in printed.out
    assert "goes on" not in printed.out
    assert printed.err == ""


def in_a_call_that_nobody_answers(name: str, later: float = 0.0) -> Background:
    """A node in the background whose timer's callback makes a blocking call, so many seconds after it has begun."""
    node = Node(name)
    client = node.create_client(AddTwoInts, "nobody_serves_this")
    begun = threading.Event()

    def ask() -> None:
        begun.set()
        time.sleep(later)
        client.call(AddTwoInts.Request())

    node.create_timer(0.005, ask)
    background = spin_in_background(node)
    assert begun.wait(20)
    return background


def test_a_call_that_waits_for_ever_is_released(
    capfd: pytest.CaptureFixture[str], count_spin_threads: Callable[[], int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The classical deadlock: call() inside a callback of a single-threaded executor."""
    monkeypatch.setattr(spin_threads, "_LONG_WAIT", 0.0)
    background = in_a_call_that_nobody_answers("deadlocked")
    background.end(grace=20)
    assert count_spin_threads() == 0
    assert isinstance(background.errors[0].error, NodeEndedError), "released, not broken off"
    assert "its own callback group" in capfd.readouterr().out


@pytest.mark.filterwarnings("error")
def test_a_callback_of_an_answer_that_never_comes_ends_in_silence() -> None:
    node = Node("patient_client")
    sent = node.create_client(AddTwoInts, "nobody_adds").call_async(AddTwoInts.Request())
    seen: list[BaseException | None] = []

    def on_answer(future: Any) -> None:
        seen.append(future.exception())
        future.result()

    sent.add_done_callback(on_answer)
    release_waiting_calls(node)
    node.destroy_node()
    assert isinstance(seen[0], NodeEndedError)


def test_a_call_that_ends_with_its_node_in_an_executor_that_no_longer_spins_ends_in_silence(
    capfd: pytest.CaptureFixture[str],
) -> None:
    node, executor = Node("doorkeeper"), MultiThreadedExecutor(num_threads=2)
    client = node.create_client(AddTwoInts, "nobody_serves_this")
    node.create_timer(0.005, lambda: client.call(AddTwoInts.Request()))
    executor.add_node(node)
    while not client._pending_requests:
        executor.spin_once(timeout_sec=0.05)
    executor.remove_node(node)
    destroy_node(node)
    executor._executor.shutdown()
    del executor
    gc.collect()
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("later", [0.0, 0.2], ids=["before the stop", "after it"])
def test_a_healthy_call_that_the_end_cuts_off_is_no_error(
    monkeypatch: pytest.MonkeyPatch, later: float
) -> None:
    monkeypatch.setattr(spin_threads, "_LONG_WAIT", 60.0)
    background = in_a_call_that_nobody_answers("healthy", later)
    background.stop()
    assert background.errors == ()


def test_a_call_from_elsewhere_does_not_outlive_its_node() -> None:
    node = Node("caller")
    client = node.create_client(AddTwoInts, "nobody_serves_this")
    background = spin_in_background(node)
    outcome: list[BaseException] = []

    def call() -> None:
        try:
            client.call(AddTwoInts.Request())
        except NodeEndedError as error:
            outcome.append(error)

    thread = threading.Thread(target=call)
    thread.start()
    while not client._pending_requests:
        time.sleep(0.001)
    background.stop()
    thread.join(20)
    assert not thread.is_alive()
    assert "caller was stopped" in str(outcome[0])


def test_stop_all_ends_every_node(nodes: Any, count_spin_threads: Callable[[], int]) -> None:
    spun, other, idle = nodes.Ticker("one"), nodes.Ticker("two"), nodes.Ticker("idle")
    spin_in_background(spun)
    spin_in_background(other, threads=2)
    stop_all()
    assert count_spin_threads() == 0
    assert all(is_destroyed(node) for node in (spun, other, idle))
