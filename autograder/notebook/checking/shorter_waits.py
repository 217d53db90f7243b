"""Waits of a subject that need not be as long while it is checked.

A student reads the verdict in the cell, so no time is spent where nothing can happen. What rclpy itself waits is cut to
the moment at which it ends: ``wait_for_service`` and ``wait_for_server`` sleep a quarter of a second at a time
(rclpy/client.py and rclpy/action/client.py, "the sleep time is arbitrary"). Where the judge knows that no server will
come for some seconds, so much of these waits is left out, and told; but not to a subject that looks at a clock, which
would see that no time has passed, nor to one that has set a timer or has a second thread that sleeps, which go by
clocks of their own. For an answer that the judge holds back it is told how long the subject would wait. What the
subject sleeps is shortened only where the scenario asks for it, in a look that is confirmed in real time where it
fails.
"""

from __future__ import annotations

import asyncio
import datetime
import functools
import math
import sys
import threading
import time
import weakref
from time import monotonic  # as it is while that of the module is watched
from typing import TYPE_CHECKING, Any, Self

import rclpy
import rclpy.action.client
import rclpy.client
from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.clock import Clock
from rclpy.node import Node

from autograder.messages.checks import Called, Spared, Willing
from autograder.notebook.cells.cell_output import is_students

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType


READY_POLL = 0.004
"""Seconds between two looks whether a server is there."""
SHORT = 0.02
"""Seconds of sleep that are never made shorter: short sleeps do not cost much and keep a loop from running hot."""
FOREVER = 3600.0
"""Seconds that are told of a wait without a limit."""

_PLACES = (
    (time, "sleep"),
    (Client, "wait_for_service"),
    (ActionClient, "wait_for_server"),
    (Client, "call_async"),
    (Client, "call"),
    (rclpy, "spin_until_future_complete"),
    (ActionClient, "send_goal_async"),
)
"""Functions that are replaced, and put back."""
_CLOCKS = (
    *(
        (time, name)
        for name in ("monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns", "time", "time_ns")
    ),
    (Clock, "now"),
)
"""The same, of clocks. Those of ``datetime`` cannot be replaced: who has imported it is taken to look at one."""
_TIMERS = ((asyncio.BaseEventLoop, "call_at"), (threading.Timer, "__init__"), (Node, "create_timer"))
"""The same, of what sets a timer. Whatever has a limit in asyncio goes by ``call_at``."""


class ShorterWaits:
    """Shortens waits within a ``with`` block; puts everything back at its end.

    Attributes:
        factor: What a sleep of the subject's is multiplied with; 1.0 leaves it alone.
        spare: Seconds of waits for a server that are still left out in this run.
    """

    def __init__(
        self, is_subject: Callable[[], bool], tell: Callable[..., None] = lambda *_, **__: None
    ) -> None:
        """Prepare.

        Args:
            is_subject: Whether the thread that asks is one of the subject's.
            tell: Tells the judge a kind of message of this run, with its data.
        """
        self._is_subject = is_subject
        self._tell = tell
        self.begin_run()

    def begin_run(self, *, factor: float = 1.0, spare: float = 0.0) -> None:
        """Begin a run with this factor and these seconds to leave out."""
        self.factor = factor
        self.spare = 0.0 if _has_imported_datetime() else spare
        self._calls = 0
        self._asleep: set[int] = set()
        self._futures: weakref.WeakSet[Any] = weakref.WeakSet()

    def __enter__(self) -> Self:
        self._usual: list[tuple[Any, str, Any]] = [
            (owner, name, getattr(owner, name)) for owner, name in _PLACES
        ]
        usual = {name: value for _, name, value in self._usual}
        usual_sleep = usual["sleep"]

        def sleep(seconds: float, /) -> None:
            if not self._is_subject():
                usual_sleep(seconds)
                return
            if self.factor < 1.0 and seconds > SHORT:
                seconds = max(SHORT, seconds * self.factor)
            thread = threading.get_ident()
            self._asleep.add(thread)
            try:
                usual_sleep(seconds)
            finally:
                self._asleep.discard(thread)

        def wait_for_service(client: Any, timeout_sec: float | None = None) -> bool:
            deadline = self._deadline(timeout_sec, client.service_is_ready, usual_sleep)
            while client.context.ok() and not client.service_is_ready() and monotonic() < deadline:
                usual_sleep(READY_POLL)
            return bool(client.service_is_ready())

        def wait_for_server(client: Any, timeout_sec: float | None = None) -> bool:
            deadline = self._deadline(timeout_sec, client.server_is_ready, usual_sleep)
            while client._node.context.ok() and not client.server_is_ready() and monotonic() < deadline:
                usual_sleep(READY_POLL)
            return bool(client.server_is_ready())

        def call_async(client: Any, request: Any) -> Any:
            future = usual["call_async"](client, request)
            if self._is_subject():
                self._calls += 1
                self._futures.add(future)
                self._tell(Called)
            return future

        def call(client: Any, request: Any, timeout_sec: float | None = None) -> Any:
            if self._is_subject():
                self._tell_patience(timeout_sec, self._calls + 1)
            return usual["call"](client, request, timeout_sec)

        def spin_until_future_complete(
            node: Any, future: Any, executor: Any = None, timeout_sec: float | None = None
        ) -> None:
            if future in self._futures:
                self._tell_patience(timeout_sec, self._calls)
            usual["spin_until_future_complete"](node, future, executor, timeout_sec)

        def send_goal_async(client: Any, *arguments: Any, **options: Any) -> Any:
            if self._is_subject():
                self._tell(Called)
            return usual["send_goal_async"](client, *arguments, **options)

        _seem_to_be_in(rclpy.client, wait_for_service, call_async, call)
        _seem_to_be_in(rclpy.action.client, wait_for_server, send_goal_async)
        _seem_to_be_in(rclpy, spin_until_future_complete)
        new = (
            sleep, wait_for_service, wait_for_server, call_async, call, spin_until_future_complete, send_goal_async
        )  # fmt: skip
        for (owner, name), function in zip(_PLACES, new, strict=True):
            setattr(owner, name, function)
        self._watch_clocks()
        return self

    def __exit__(self, *_: object) -> None:
        for owner, name, value in self._usual:
            setattr(owner, name, value)

    def _watch_clocks(self) -> None:
        """Spare a subject nothing from the moment on in which its own code looks at a clock, or it sets a timer."""
        for owner, name in _CLOCKS + _TIMERS:
            clock = getattr(owner, name)
            watched = self._watched(clock, by_student=(owner, name) in _CLOCKS)
            # ``from time import monotonic`` has given it a name in the notebook, too.
            notebook = sys.modules["__main__"]
            names = [(notebook, name) for name, value in list(vars(notebook).items()) if value is clock]
            for place in ((owner, name), *names):
                self._usual.append((*place, clock))
                setattr(*place, watched)

    def _watched(self, clock: Callable[..., Any], *, by_student: bool) -> Callable[..., Any]:
        @functools.wraps(clock)
        def watched(*arguments: Any, **options: Any) -> Any:
            # rclpy looks at clocks, too. A timer is set for the subject, whoever does it.
            if (
                self.spare
                and self._is_subject()
                and (not by_student or is_students(sys._getframe(1).f_code.co_filename))
            ):
                self.spare = 0.0
            return clock(*arguments, **options)

        return watched

    def _deadline(
        self, timeout_sec: float | None, ready: Callable[[], bool], usual_sleep: Callable[[float], None]
    ) -> float:
        """The end of a wait that begins now; what can be left out of it is left out, and told."""
        left = math.inf if timeout_sec is None else timeout_sec
        if self._asleep - {threading.get_ident()}:
            self.spare = 0.0
        if self.spare > 0.0 and left > 0.0 and self._is_subject() and not ready():
            spared = min(left, self.spare)
            self.spare -= spared
            left -= spared
            self._tell(Spared, seconds=float(spared))
            usual_sleep(min(SHORT, spared))
        return monotonic() + left

    def _tell_patience(self, timeout_sec: float | None, call: int) -> None:
        seconds = FOREVER if timeout_sec is None else timeout_sec
        self._tell(Willing, seconds=float(seconds), call=call)


def _has_imported_datetime() -> bool:
    values = list(vars(sys.modules["__main__"]).values())
    return any(value is datetime or value is datetime.datetime for value in values)


def _seem_to_be_in(module: ModuleType, *functions: Any) -> None:
    """Let stacks and errors name the functions as if they were rclpy's, which the judge and the student know."""
    for function in functions:
        function.__code__ = function.__code__.replace(co_filename=str(module.__file__))
        function.__qualname__ = function.__name__


QUESTIONS = ("get_service_names_and_types", "get_service_names_and_types_by_node")
"""The questions to the graph that are told of."""
LOOKS_TOLD = 10
"""Looks that are told of in one run; a loop without a pause makes thousands in a second."""


class GraphQuestions:
    """Tells the judge, within a ``with`` block, that a subject looks at the graph; it cannot see that from outside.

    A subject that looks again and again is waiting for something. Told so, the judge need not let time pass to find
    out.
    """

    def __init__(self, tell: Callable[[], None], is_subject: Callable[[], bool]) -> None:
        """Prepare.

        Args:
            tell: Called at each look.
            is_subject: Whether the thread that asks is one of the subject's.
        """
        self._tell = tell
        self._is_subject = is_subject
        self._told = 0

    def begin_run(self) -> None:
        """Count from the start."""
        self._told = 0

    def __enter__(self) -> Self:
        self._usual = [(name, getattr(Node, name)) for name in QUESTIONS]
        for name, ask in self._usual:
            setattr(Node, name, self._noticed(ask))
        return self

    def __exit__(self, *_: object) -> None:
        for name, ask in self._usual:
            setattr(Node, name, ask)

    def _noticed(self, ask: Any) -> Any:
        @functools.wraps(ask)
        def asked(*arguments: Any, **options: Any) -> Any:
            answer = ask(*arguments, **options)
            if self._told < LOOKS_TOLD and self._is_subject():
                self._told += 1
                self._tell()
            return answer

        return asked
