"""``with spinning(...)``: nodes live exactly as long as the block."""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from my_robot_interfaces.action import Fibonacci
from my_robot_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node

from autograder.notebook.checking.subject_reports import CapturedOutput
from autograder.notebook.nodes import spin_threads
from autograder.notebook.nodes.background_nodes import Interrupted, spinning
from autograder.notebook.nodes.spin_threads import SpinThreads

if TYPE_CHECKING:
    from collections.abc import Callable

pytestmark = [pytest.mark.ros, pytest.mark.usefixtures("ros")]


def test_as_gives_the_node_or_a_tuple_of_them(nodes: Any) -> None:
    ticker, listener = nodes.Ticker(), nodes.Listener()
    with spinning(ticker) as one:
        assert one is ticker
    ticker = nodes.Ticker()
    with spinning(ticker, listener) as several:
        assert several == (ticker, listener)


@pytest.mark.parametrize("threads", [1, 3])
def test_callbacks_run_while_the_body_runs(nodes: Any, threads: int) -> None:
    with spinning(nodes.Ticker(), nodes.Listener(), threads=threads) as (ticker, listener):
        ticker.wait_for_ticks(5)
        first = int(listener.heard.get(timeout=180))
        assert listener.heard.get(timeout=180) == str(first + 1), "each tick is heard once"


def test_the_next_callback_is_handed_out_when_one_has_returned(
    nodes: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or has taken longer than a turn. A loop that goes on at once lets no other thread have the interpreter."""
    returned: list[bool] = []
    hand_out = SpinThreads._hand_out

    def watched(threads: SpinThreads, work: Any) -> None:
        hand_out(threads, work)
        returned.append(work.task.done())

    monkeypatch.setattr(SpinThreads, "_hand_out", watched)
    monkeypatch.setattr(spin_threads, "_TURN", 180.0)
    with spinning(nodes.Ticker(), threads=2) as ticker:
        ticker.wait_for_ticks(5)
        assert len(returned) > 3
        assert all(returned)


def test_the_stacks_leave_out_a_thread_between_two_callbacks(
    nodes: Any, until: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has no call of rclpy, as if nothing spun the node."""
    begins = threading.Event()
    monkeypatch.setattr(SpinThreads, "_run_queued_work", begins.wait)
    monkeypatch.setattr(spin_threads, "_TURN", 180.0)
    captured = CapturedOutput(lambda *_: None)
    spun = SpinThreads([nodes.Ticker()], threads=2, on_failure=lambda _: None, on_end=lambda _: None)
    spun.start()
    until(lambda: spun._queued)
    assert captured.stacks() == ("", 0.0)
    begins.set()
    for returned in spun._queued.values():
        returned.set()
    spun.stop()


@pytest.mark.parametrize("threads", [1, 3])
def test_at_the_end_nothing_is_left(
    nodes: Any, graph: Node, threads: int, until: Any, count_spin_threads: Callable[[], int]
) -> None:
    with spinning(nodes.Ticker(), threads=threads) as ticker:
        ticker.wait_for_ticks(1)
        until(lambda: "ticker" in graph.get_node_names())
        executor = ticker.executor
    assert count_spin_threads() == 0
    assert executor.get_nodes() == []
    until(lambda: "ticker" not in graph.get_node_names())


def test_an_action_server_leaves_the_graph_with_its_node(graph: Node, until: Any) -> None:
    """Node.destroy_node alone leaves it there: goals would go on being sent to it."""

    def services() -> set[str]:
        return {name for name, _ in graph.get_service_names_and_types() if "fibonacci" in name}

    node = Node("fibonacci_server")
    ActionServer(node, Fibonacci, "fibonacci", lambda goal: Fibonacci.Result())
    with spinning(node):
        until(services)
    until(lambda: not services() and "fibonacci_server" not in graph.get_node_names())


def test_an_error_in_the_body_passes_and_the_nodes_end(
    nodes: Any, count_spin_threads: Callable[[], int]
) -> None:
    def spin() -> None:
        with spinning(nodes.Ticker()) as ticker:
            ticker.wait_for_ticks(1)
            raise LookupError

    with pytest.raises(LookupError):
        spin()
    assert count_spin_threads() == 0


def test_an_interrupt_ends_the_block_in_one_line(nodes: Any, count_spin_threads: Callable[[], int]) -> None:
    with pytest.raises(Interrupted, match="ticker stopped") as raised, spinning(nodes.Ticker()):
        raise KeyboardInterrupt
    assert isinstance(raised.value, KeyboardInterrupt)
    assert raised.value._render_traceback_() == ["Interrupted: ticker stopped."]
    assert count_spin_threads() == 0
    assert rclpy.ok()


def test_threads_choose_the_executor(nodes: Any) -> None:
    with spinning(nodes.Ticker()) as ticker:
        assert isinstance(ticker.executor, SingleThreadedExecutor)
    with spinning(nodes.Ticker(), threads=2) as ticker:
        assert isinstance(ticker.executor, MultiThreadedExecutor)


def test_two_threads_run_two_callbacks_at_a_time() -> None:
    node = Node("pair")
    both_are_in = threading.Barrier(2)
    met = threading.Event()

    def meet() -> None:
        if not met.is_set():
            with suppress(threading.BrokenBarrierError):  # How one ends that came in alone after the two.
                both_are_in.wait(timeout=180)
                met.set()

    group = ReentrantCallbackGroup()
    for _ in range(2):
        node.create_timer(0.005, meet, callback_group=group)
    with spinning(node, threads=2):
        assert met.wait(20)
        both_are_in.abort()


def test_one_thread_runs_one_callback_at_a_time() -> None:
    node = Node("single")
    inside: list[int] = []
    crowds: list[int] = []
    done = threading.Event()

    def enter() -> None:
        inside.append(1)
        crowds.append(len(inside))
        if len(crowds) > 20:
            done.set()
        inside.pop()

    group = ReentrantCallbackGroup()
    for _ in range(3):
        node.create_timer(0.002, enter, callback_group=group)
    with spinning(node):
        assert done.wait(20)
    assert set(crowds) == {1}


def test_the_nodes_own_context_is_used(nodes: Any) -> None:
    """A check swaps the default context; nodes of another one are spun all the same."""
    context = rclpy.Context()
    context.init(args=[], domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    rclpy.shutdown()
    assert not rclpy.ok()
    called = threading.Event()
    node = Node("elsewhere", context=context)
    node.create_timer(0.005, called.set)
    with spinning(node):
        assert node.executor is not None
        assert node.executor.context is context
        assert called.wait(20)
    context.shutdown()


@pytest.mark.parametrize("threads", [1, 3])
def test_an_async_callback_goes_on_when_its_answer_comes(threads: int) -> None:
    node = Node("asker")
    group = ReentrantCallbackGroup()
    client = node.create_client(AddTwoInts, "add_two_ints", callback_group=group)
    sums: list[int] = []
    done = threading.Event()

    def add(request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response

    async def ask() -> None:
        timer.cancel()
        answer = await client.call_async(AddTwoInts.Request(a=2, b=3))
        sums.append(answer.sum)
        done.set()

    node.create_service(AddTwoInts, "add_two_ints", add, callback_group=group)
    assert client.wait_for_service(20)
    timer = node.create_timer(0.005, ask, callback_group=group)
    with spinning(node, threads=threads):
        assert done.wait(20)
    assert sums == [5]


@pytest.mark.filterwarnings("error")
def test_a_callback_that_still_awaits_is_closed_in_silence(capfd: pytest.CaptureFixture[str]) -> None:
    node = Node("patient")
    client = node.create_client(AddTwoInts, "nobody_serves_this", callback_group=ReentrantCallbackGroup())
    waiting, closed = threading.Event(), threading.Event()

    async def ask() -> None:
        timer.cancel()
        waiting.set()
        try:
            await client.call_async(AddTwoInts.Request())
        finally:
            closed.set()

    timer = node.create_timer(0.005, ask)
    with spinning(node):
        assert waiting.wait(20)
    assert closed.is_set()
    assert capfd.readouterr().err == ""


def test_forgetting_with_is_told(nodes: Any) -> None:
    assert repr(spinning(nodes.Ticker())) == (
        "ticker not spinning: write `with spinning(...):` and indent the lines that run meanwhile."
    )
