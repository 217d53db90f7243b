"""An exception in a callback: its traceback reaches the student, and everything else goes on."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import pytest
from my_robot_interfaces.action import Fibonacci
from my_robot_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node

from autograder.notebook.nodes.background_nodes import spin_in_background, spinning
from autograder.notebook.nodes.node_errors import CallbackFailedError

if TYPE_CHECKING:
    from collections.abc import Callable

pytestmark = [pytest.mark.ros, pytest.mark.usefixtures("ros")]

ABORTED = 6


@pytest.mark.parametrize("threads", [1, 3])
def test_it_is_shown_once_on_stdout_counted_and_raised_at_the_end(
    nodes: Any, threads: int, capfd: pytest.CaptureFixture[str]
) -> None:
    def spin() -> None:
        with spinning(nodes.Failing(), nodes.Ticker(), threads=threads) as (failing, ticker):
            failing.wait_for_ticks(12)
            ticker.wait_for_ticks(2)

    with pytest.raises(CallbackFailedError) as raised:
        spin()
    printed = capfd.readouterr()
    assert printed.err == ""
    assert printed.out.count("Traceback") == 1
    assert "Error in ticker, in the callback of its timer (every 0.005 s):" in printed.out
    assert 'raise RuntimeError("no such robot")' in printed.out
    assert printed.out.count("The same error has now happened 10 times") == 1
    assert "rclpy/" not in printed.out, "only the student's own frames"
    assert "spin_threads" not in printed.out
    (error,) = raised.value.errors
    assert error.count >= 12
    assert isinstance(error.error, RuntimeError)
    assert f"{error.count} times: RuntimeError: no such robot" in str(raised.value)


def test_different_errors_are_shown_each(capfd: pytest.CaptureFixture[str]) -> None:
    node = Node("clumsy")
    done = threading.Event()
    turns = iter(range(100))

    def stumble() -> None:
        turn = next(turns)
        if turn >= 4:
            done.set()
        if turn % 2:
            raise KeyError("odd")
        raise ValueError("even")

    node.create_timer(0.005, stumble)
    with pytest.raises(CallbackFailedError) as raised, spinning(node):
        assert done.wait(20)
    assert [type(error.error) for error in raised.value.errors] == [ValueError, KeyError]
    assert capfd.readouterr().out.count("Traceback") == 2


def test_an_error_of_the_body_is_the_one_that_is_raised(nodes: Any) -> None:
    def spin() -> None:
        with spinning(nodes.Failing()) as failing:
            failing.wait_for_ticks(1)
            raise LookupError("the body's")

    with pytest.raises(LookupError, match="the body's"):
        spin()


def test_a_background_shows_it_and_goes_on(nodes: Any, capfd: pytest.CaptureFixture[str]) -> None:
    failing = nodes.Failing()
    background = spin_in_background(failing)
    failing.wait_for_ticks(5)
    assert background.running
    assert "Errors so far: " in repr(background)
    background.stop()
    printed = capfd.readouterr()
    assert printed.out.count("Traceback") == 1
    count = background.errors[0].count
    assert f"Error in ticker, in the callback of its timer (every 0.005 s), {count} times" in printed.out
    assert printed.err == ""


class Eager(Node):
    def say_hello(self) -> None:
        """Is called when the timer is made."""


@pytest.mark.parametrize(("made", "method"), [(Eager, "say_hello"), (Node, "your_method")])
def test_a_timer_made_with_the_result_of_its_callback_is_explained(
    made: type[Node], method: str, capfd: pytest.CaptureFixture[str], until: Callable[[Any], Any]
) -> None:
    node = made("eager")
    node.create_timer(0.005, None)  # type: ignore[arg-type]
    background = spin_in_background(node)
    until(lambda: background.errors)
    background.stop()
    printed = capfd.readouterr().out
    assert "'NoneType' object is not callable" in printed
    assert f"without parentheses: create_timer(0.005, self.{method})" in printed
    assert "Traceback" not in printed


def test_a_service_that_returns_nothing_is_explained_and_serves_on(
    capfd: pytest.CaptureFixture[str], until: Callable[[Any], Any]
) -> None:
    node = Node("forgetful")
    calls = iter(range(100))

    def add(request: Any, response: Any) -> Any:
        return response if next(calls) else None

    node.create_service(AddTwoInts, "add", add)
    client = node.create_client(AddTwoInts, "add")
    assert client.wait_for_service(20)
    background = spin_in_background(node)
    client.call_async(AddTwoInts.Request())
    until(lambda: background.errors)
    assert client.call(AddTwoInts.Request(), timeout_sec=180) is not None
    background.stop()
    assert "must return its response: end it with `return response`" in capfd.readouterr().out


@pytest.mark.parametrize("mistake", ["raises", "returns nothing"])
def test_a_failing_goal_is_shown_on_stdout_and_aborted(
    mistake: str, capfd: pytest.CaptureFixture[str], until: Callable[[Any], Any]
) -> None:
    node = Node("fibonacci_server")

    def execute(goal_handle: Any) -> Any:
        if mistake == "raises":
            raise OverflowError("too large")

    ActionServer(node, Fibonacci, "fibonacci", execute)
    client = ActionClient(node, Fibonacci, "fibonacci")
    background = spin_in_background(node)
    assert client.wait_for_server(20)
    sent = client.send_goal_async(Fibonacci.Goal(order=3))
    until(sent.done)
    answer = sent.result().get_result_async()
    until(answer.done)
    background.stop()
    assert answer.result().status == ABORTED
    printed = capfd.readouterr()
    assert printed.err == ""
    assert "Error in fibonacci_server, in the callback of its action server" in printed.out
    assert ("too large" if mistake == "raises" else "end it with `return result`") in printed.out


def test_a_done_callbacks_error_is_shown(
    capfd: pytest.CaptureFixture[str], until: Callable[[Any], Any]
) -> None:
    node = Node("asker")
    node.create_service(AddTwoInts, "add", lambda request, response: response)
    client = node.create_client(AddTwoInts, "add")
    assert client.wait_for_service(20)
    background = spin_in_background(node)

    def use(future: Any) -> None:
        raise ValueError("in a done callback")

    client.call_async(AddTwoInts.Request()).add_done_callback(use)
    until(lambda: background.errors)
    background.stop()
    printed = capfd.readouterr()
    assert "in a done callback" in printed.out
    assert printed.err == ""
