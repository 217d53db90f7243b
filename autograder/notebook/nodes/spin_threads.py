"""Spins nodes in background threads, and ends these threads.

Three properties of rclpy shape this file (``rclpy/executors.py`` of Jazzy):

* an exception in a callback ends ``spin``, so the thread would end, and all its nodes would stop;
* ``Executor.shutdown`` destroys the executor even if another thread still waits in it, so this thread must end first;
* nodes reference their executor only weakly, so this module keeps a reference to it.

One property of Python matters as well: a thread that still runs rclpy code when the interpreter ends aborts the whole
process. So every thread is joined, and a callback that does not return is interrupted by an exception.
"""

from __future__ import annotations

import ctypes
import queue
import sys
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from types import TracebackType
from typing import TYPE_CHECKING, Any

from rclpy.exceptions import InvalidHandle
from rclpy.executors import ConditionReachedException, ExternalShutdownException, ShutdownException

from autograder.notebook.nodes.lending_executors import make_executor, wake_global_executor
from autograder.notebook.nodes.ros_session import (
    NodeEndedError,
    destroy_node,
    is_being_destroyed,
    release_waiting_calls,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import FrameType

    from rclpy.node import Node
    from rclpy.task import Task

GRACE = 2.0
"""Seconds for a running callback to return by itself after a stop was requested."""
_RELEASE_EVERY = 0.05
"""Seconds between two searches for service calls and goals that wait for an answer."""
_LAST_GRACE = 1.0
"""Seconds for a callback to end after it was interrupted."""
_ATTEMPTS = 3
_TURN = 0.001
"""Maximum number of seconds for a thread to return from a callback before the next callback is handed out."""
_LONG_WAIT = 1.0
"""When a node is stopped, a service call that has waited for its answer longer than this, in seconds, counts as hung.
"""
_MAX_FAILED_WAITS = 10


class CallbackBrokenOff(BaseException):
    """Raised inside a callback that does not return when its node has to stop, to interrupt the callback."""

    def __str__(self) -> str:
        return "the callback did not return when its node was stopped, so it was interrupted here"


class SpinEnding(Enum):
    """The reasons why nodes no longer spin."""

    STOPPED = "stopped"
    ROS_SHUT_DOWN = "ROS was shut down"
    CALLBACK_ASKED = "a callback raised SystemExit"
    EXECUTOR_FAILED = "the executor failed"


@dataclass(frozen=True)
class SpinFailure:
    """An exception that a callback raised.

    Attributes:
        error: The exception, with its traceback.
        entity: The owner of the callback, such as a timer, subscription or service; None for a task.
        node: The node to which the entity belongs; None for a task.
        goes_on: True if the nodes keep spinning after the exception.
    """

    error: BaseException
    entity: Any = None
    node: Node | None = None
    goes_on: bool = True


@dataclass(frozen=True)
class _Work:
    task: Task
    entity: Any
    node: Node | None


@dataclass(frozen=True)
class _BusyThread:
    work: _Work
    since: float


class SpinThreads:
    """Spins nodes in separate threads until stopped, then destroys them.

    Args:
        nodes: At least one node; all of the same context.
        threads: The number of callbacks that may run at the same time. With 2 or more, the executor is
            multi-threaded.
        on_failure: Called for each callback that raised an exception, in the thread that ran the callback.
        on_end: Called once with the reason, after the nodes are destroyed.
    """

    def __init__(
        self,
        nodes: Sequence[Node],
        *,
        threads: int = 1,
        on_failure: Callable[[SpinFailure], None],
        on_end: Callable[[SpinEnding], None],
    ) -> None:
        self._context = nodes[0].context
        self.executor = make_executor(threads, self._context)
        self.executor.on_goal_error = lambda error, server: self._report(error, server, server._node)
        self._on_failure = on_failure
        self._on_end = on_end
        self._nodes = tuple(nodes)
        self._stop = threading.Event()
        self._ending = SpinEnding.STOPPED
        self._lock = threading.Lock()
        self._finish_lock = threading.RLock()
        self._finished = False
        self._to_workers: queue.SimpleQueue[_Work | None] = queue.SimpleQueue()
        self._queued: dict[Task, threading.Event] = {}
        """The tasks that no thread has begun, each with an event that is set when its callback has returned."""
        self._running: dict[int, _BusyThread] = {}
        # A single thread runs the callbacks itself, as a SingleThreadedExecutor does.
        self._workers = threads if threads > 1 else 0
        self._threads = [self._make_thread(self._take_work)]
        self._threads += [self._make_thread(self._run_queued_work) for _ in range(self._workers)]
        self._alive = len(self._threads)

    def _make_thread(self, job: Callable[[], None]) -> threading.Thread:
        # This must be a daemon thread: Python joins all other threads before it runs exit handlers, so a callback that
        # hangs would keep the kernel from ending.
        return threading.Thread(target=self._thread, args=(job,), name="ros-spin", daemon=True)

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes that these threads spin, and destroy when they are stopped."""
        return self._nodes

    @property
    def running(self) -> bool:
        """True if the nodes spin and no stop was requested."""
        return self._threads[0].is_alive() and not self._stop.is_set()

    def is_own_thread(self) -> bool:
        """Return True if the caller runs in one of the spinning threads, that is, in a callback."""
        return threading.current_thread() in self._threads

    def start(self) -> None:
        """Start spinning."""
        for node in self._nodes:
            self.executor.add_node(node)
        for thread in self._threads:
            thread.start()

    def let_go(self, node: Node) -> None:
        """Stop spinning one node without destroying it."""
        self.executor.release(node)
        self._nodes = tuple(other for other in self._nodes if other is not node)

    def stop(self, grace: float = GRACE) -> None:
        """Stop spinning, wait for the callbacks that are running, and destroy the nodes.

        A callback that does not return in time is interrupted and reported as a failure. If a callback itself calls
        this method, the nodes stop after that callback.

        Args:
            grace: Seconds for a running callback to return by itself.
        """
        self._ask_to_stop(SpinEnding.STOPPED)
        if self.is_own_thread():
            return
        if not self._await_callbacks(grace):
            self._break_off()
        self._finish()

    def _await_callbacks(self, grace: float) -> bool:
        """Wait for the running callbacks. Return False if one has not returned within ``grace`` seconds."""
        deadline = time.monotonic() + grace
        while True:
            # No answers are received any more, so a callback that waits for one would wait forever. Release it. The
            # loop repeats the release, because another callback may have begun to wait only now.
            for node in self._nodes:
                release_waiting_calls(node)
            left = deadline - time.monotonic()
            if self._join(min(_RELEASE_EVERY, left)):
                return True
            if left <= 0:
                return False

    def _ask_to_stop(self, ending: SpinEnding) -> None:
        with self._lock:
            if not self._stop.is_set():
                self._ending = ending
                self._stop.set()
        with suppress(InvalidHandle):
            self.executor.wake()

    def _join(self, limit: float) -> bool:
        """Wait at most ``limit`` seconds for all threads to end. Return True if they have ended."""
        deadline = time.monotonic() + limit
        for thread in self._threads:
            if thread.ident is not None:
                thread.join(max(0.0, deadline - time.monotonic()))
        return not any(thread.is_alive() for thread in self._threads)

    def _break_off(self) -> None:
        for _ in range(
            _ATTEMPTS
        ):  # interrupt again, because a loop with a bare `except:` survives the first interruption
            for ident in list(self._running):
                raise_in_thread(ident, CallbackBrokenOff)
            wake_global_executor()
            if self._join(_LAST_GRACE / _ATTEMPTS):
                return
        # The callback hangs in compiled code, or catches every exception. Leave its thread alone: the thread runs no
        # rclpy code, so it does no harm when the interpreter ends.
        frames = sys._current_frames()
        for ident, running in list(self._running.items()):
            error = CallbackBrokenOff().with_traceback(_traceback_of(frames.get(ident)))
            self._on_failure(SpinFailure(error, running.work.entity, running.work.node, goes_on=False))

    def _finish(self) -> None:
        """Destroy the nodes and the executor. A second call does nothing."""
        with self._finish_lock:
            if self._finished:
                return
            self.executor.on_taken = None
            for node in self._nodes:
                destroy_node(node)
            self._close_unfinished_tasks()
            with suppress(InvalidHandle):
                self.executor.shutdown()
            self._finished = True
        self._on_end(self._ending)

    def _close_unfinished_tasks(self) -> None:
        """Cancel coroutines that will not run any more. Otherwise Python would warn about them on stderr."""
        for task, *_ in list(getattr(self.executor, "_tasks", ())):
            if not task.executing():
                with suppress(Exception):
                    task.cancel()

    # The methods below run in the spinning threads.

    def _thread(self, job: Callable[[], None]) -> None:
        try:
            job()
        except CallbackBrokenOff:
            pass  # the callback had already returned when it was interrupted
        finally:
            with self._lock:
                self._alive -= 1
                last_one_out = self._alive == 0
            if last_one_out:
                self._finish()

    def _take_work(self) -> None:
        """Wait for messages and timers, and run their callbacks or hand them to the other threads, until stopped."""
        failed_waits = 0
        try:
            while not self._stop.is_set():
                try:
                    work = self._next_work()
                except Exception as error:  # for example InvalidHandle, while a node is being destroyed
                    failed_waits += 1
                    if failed_waits == _MAX_FAILED_WAITS:
                        self._on_failure(SpinFailure(error, goes_on=False))
                        self._ask_to_stop(SpinEnding.EXECUTOR_FAILED)
                else:
                    failed_waits = 0
                    if work is not None:
                        self._hand_out(work)
        finally:
            for _ in range(self._workers):
                self._to_workers.put(None)

    def _next_work(self) -> _Work | None:
        """Return the next callback that is ready; None if there is none at the moment."""
        try:
            if not self._context.ok():
                raise ExternalShutdownException
            return _Work(*self.executor.wait_for_ready_callbacks(None, None, self._stop.is_set))
        except (ExternalShutdownException, ShutdownException):
            self._ask_to_stop(SpinEnding.ROS_SHUT_DOWN)
        except ConditionReachedException:
            pass  # stopped
        return None

    def _hand_out(self, work: _Work) -> None:
        if not self._workers:
            self._run(work)
            return
        returned = self._queued.get(work.task)
        if returned is None:
            returned = self._queued[work.task] = threading.Event()
            self._to_workers.put(work)
        # rclpy offers a task until it runs, and the wait set wakes until its data is taken: without this wait, the loop
        # would hold the interpreter's lock, and the thread that is to take the data would get it each 5 ms.
        returned.wait(_TURN)

    def _run_queued_work(self) -> None:
        while (work := self._to_workers.get()) is not None:
            # Remove the task before it runs: if its callback awaits something, rclpy offers the task again, and it
            # must then be queued again.
            returned = self._queued.pop(work.task)
            if not self._stop.is_set():
                self._run(work)
            returned.set()

    def _run(self, work: _Work) -> None:
        ident = threading.get_ident()
        self._running[ident] = _BusyThread(work, time.monotonic())
        try:
            work.task()
            error = work.task.exception() if work.task.done() else None
        except SystemExit:
            error = None
            self._ask_to_stop(SpinEnding.CALLBACK_ASKED)
        except BaseException as raised:
            error = raised
        finally:
            running = self._running.pop(ident)
        if error is not None and not self._is_of_the_end(error, running):
            self._report(error, work.entity, work.node)

    def _report(self, error: BaseException, entity: Any, node: Node | None) -> None:
        if node is not None and isinstance(error, InvalidHandle) and is_being_destroyed(node):
            return  # a cell destroys the node while one of its callbacks still uses it
        self._on_failure(SpinFailure(error, entity, node, goes_on=not self._stop.is_set()))

    def _is_of_the_end(self, error: BaseException, running: _BusyThread) -> bool:
        """Return True if a callback failed only because its node was stopped while a call waited for an answer."""
        waited = time.monotonic() - running.since
        return self._stop.is_set() and isinstance(error, NodeEndedError) and waited < _LONG_WAIT


def raise_in_thread(ident: int, error: type[BaseException]) -> None:
    """Raise an exception in another thread, when that thread next runs Python code.

    Args:
        ident: The id of the thread.
        error: The class of the exception.
    """
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(ident), ctypes.py_object(error))


def _traceback_of(frame: FrameType | None) -> TracebackType | None:
    """Return the stack of a running thread as a traceback."""
    traceback = None
    while frame is not None:
        traceback = TracebackType(traceback, frame, frame.f_lasti, frame.f_lineno)
        frame = frame.f_back
    return traceback
