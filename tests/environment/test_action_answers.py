"""No answer to a goal, a cancel request or a result request is lost while another thread spins.

The order that loses one is forced: the other thread has taken the answer, or waits to take it, before the thread that
sends goes on behind the request and notes its number (:data:`environment.wheel_repairs.SOURCE_REPAIRS`).
"""

from __future__ import annotations

import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.action import client as client_module
from rclpy.executors import SingleThreadedExecutor

from autograder.dds_discovery import claim_free_domain

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import TracebackType

    from rclpy.task import Future

pytestmark = pytest.mark.ros
LIMIT = 30.0
"""Seconds after which an answer is lost. All others come within milliseconds."""


class WatchedLock:
    """A reentrant lock that sets an event when a thread has to wait for it."""

    def __init__(self, has_come: threading.Event) -> None:
        self._lock, self._has_come = threading.RLock(), has_come

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            self._has_come.set()
            self._lock.acquire()

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._lock.release()


class PausedHandle:
    """The compiled part of an action client, which returns from a request only when another thread has come."""

    def __init__(self, handle: Any, request: str, has_come: threading.Event) -> None:
        self._handle, self._request, self._has_come = handle, request, has_come

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._handle, name)
        if name != self._request:
            return method

        def paused(*arguments: object) -> Any:
            self._has_come.clear()
            number = method(*arguments)
            assert self._has_come.wait(LIMIT)
            return number

        return paused


class WatchedClient(ActionClient):
    """An action client that sets an event when a thread has handled an answer."""

    has_come: threading.Event
    answer: str

    async def execute(self, taken_data: dict[str, Any]) -> None:
        await super().execute(taken_data)  # type: ignore[no-untyped-call]
        if self.answer in taken_data:
            self.has_come.set()


@pytest.fixture
def spun() -> Iterator[Callable[[str], Any]]:
    """Return a function that makes a node, which a thread of its own spins until the test ends."""
    claim, context = claim_free_domain(), rclpy.Context()
    context.init(domain_id=claim.domain)
    ends: list[Callable[[], object]] = []

    def make(name: str) -> Any:
        node = rclpy.create_node(name, context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin)
        thread.start()
        ends.extend([executor.shutdown, thread.join, node.destroy_node])
        return node

    yield make
    for end in ends:
        end()
    context.shutdown()
    claim.release()


def answer_of(future: Future) -> Any:
    """Return the result of a future that another thread sets."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    assert done.wait(LIMIT), "the answer is lost"
    return future.result()


@pytest.mark.parametrize("answer", ["goal", "cancel", "result"])
def test_an_answer_that_another_thread_would_take_early(
    answer: str, spun: Callable[[str], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    if not (Path(sys.prefix) / "share/rclpy").is_dir():
        pytest.skip("a ROS that was sourced is as it is")
    has_come = threading.Event()
    watched = SimpleNamespace(RLock=lambda: WatchedLock(has_come), Event=threading.Event)
    monkeypatch.setattr(client_module, "threading", watched)
    node = spun("client")
    client: Any = WatchedClient(node, Fibonacci, "fibonacci")  # type: ignore[no-untyped-call]
    monkeypatch.undo()
    client.has_come, client.answer = has_come, answer

    def succeed(goal: Any) -> Any:
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1])

    server = ActionServer(spun("server"), Fibonacci, "fibonacci", succeed)
    assert client.wait_for_server(LIMIT)
    handle = answer_of(client.send_goal_async(Fibonacci.Goal(order=2)))
    client._client_handle = PausedHandle(client._client_handle, f"send_{answer}_request", has_come)
    requests = {
        "goal": lambda: client.send_goal_async(Fibonacci.Goal(order=2)),
        "cancel": lambda: handle.cancel_goal_async(),
        "result": lambda: handle.get_result_async(),
    }
    assert answer_of(requests[answer]()) is not None
    server.destroy()
