"""Shows exceptions in callbacks: the traceback at the first time, then only a count."""

from __future__ import annotations

import threading
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer
from rclpy.client import Client
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Timer

from autograder.notebook.cells.cell_output import PlainlyShownError, last_student_line, render, say
from autograder.notebook.nodes.kernel_nodes import NodeEndedError, node_label

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rclpy.node import Node

    from autograder.notebook.nodes.spin_threads import SpinFailure


_HUNG_CALL = (
    "While a callback waits in call(), only another thread can take the answer: "
    "give the client its own callback group, and spin with threads=2."
)


@dataclass(frozen=True)
class CallbackError:
    """One error in a callback, with the number of times it happened.

    Attributes:
        node: The node's name.
        where: The owner of the callback in words, such as ``"its timer (every 0.5 s)"``.
        error: The first of the exceptions, with its traceback.
        count: The number of times that the error happened.
    """

    node: str
    where: str
    error: BaseException
    count: int = 1

    def __str__(self) -> str:
        """Return one line that names the node, the owner of the callback, the count and the error."""
        times = "" if self.count == 1 else f", {self.count} times"
        return f"{self.node}, in the callback of {self.where}{times}: {_last_line(self.error)}"


class CallbackFailedError(PlainlyShownError, RuntimeError):
    """A callback raised an exception during ``with spinning(...)``. Its traceback has been shown already.

    Attributes:
        errors: The errors of callbacks, sorted by when they first happened.
    """

    def __init__(self, errors: Sequence[CallbackError]) -> None:
        self.errors = tuple(errors)
        super().__init__("\n".join(map(str, errors)))

    def _render_traceback_(self) -> list[str]:
        return [f"{type(self).__name__}: {self}", "(traceback above)"]


class CallbackErrors:
    """Collects the errors in the callbacks of one :class:`.Background`, and shows each new error in the notebook."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._errors: dict[Any, CallbackError] = {}

    def record(self, failure: SpinFailure) -> None:
        """Record an error, and show it if it is new."""
        key = (type(failure.error), id(failure.entity), last_student_line(failure.error))
        with self._lock:
            known = self._errors.get(key)
            if known is None:
                seen = CallbackError(node_label(failure.node), describe(failure.entity), failure.error)
            else:
                seen = replace(known, count=known.count + 1)
            self._errors[key] = seen
        if known is None:
            say(_report(seen, failure))
        elif _is_milestone(seen.count):
            say(f"The same error has now happened {seen.count} times: {_last_line(seen.error)}")

    @property
    def all(self) -> tuple[CallbackError, ...]:
        """Return the errors so far, sorted by when they first happened."""
        with self._lock:
            return tuple(self._errors.values())

    def show_counts(self) -> None:
        """Print how often each repeated error happened."""
        for seen in self.all:
            if seen.count > 1:
                say(f"Error in {seen}")


def _report(seen: CallbackError, failure: SpinFailure) -> str:
    lines = [f"Error in {seen.node}, in the callback of {seen.where}:"]
    if last_student_line(seen.error) is None:
        lines += [_last_line(seen.error), *_hints(failure)]
    else:
        lines += render(seen.error)
    if isinstance(seen.error, NodeEndedError):
        lines.append(_HUNG_CALL)
    if failure.goes_on:
        lines.append(f"{seen.node} goes on. The same error will only be counted.")
    return "\n".join(lines)


def _hints(failure: SpinFailure) -> list[str]:
    """Return advice if rclpy itself raised the error because the callback, or its return value, is wrong."""
    if isinstance(failure.entity, Timer) and failure.entity.callback is None:
        return [
            "The timer's callback is None, because the method was called when the timer was made. "
            "Pass the method itself, without parentheses: "
            f"create_timer({failure.entity.timer_period_ns / 1e9:g}, self.{_likely_callback(failure.node)})."
        ]
    if isinstance(failure.entity, Service):
        return ["The callback of a service must return its response: end it with `return response`."]
    return []


def _likely_callback(node: Node | None) -> str:
    """Return the name of the only method of the student's class; ``your_method`` if it has several."""
    own = [name for name, value in vars(type(node)).items() if callable(value) and not name.startswith("__")]
    return own[0] if len(own) == 1 else "your_method"


def describe(entity: Any) -> str:
    """Return the owner of a callback in words, such as ``its service /reset``."""
    if isinstance(entity, Timer):
        return f"its timer (every {entity.timer_period_ns / 1e9:g} s)"
    if isinstance(entity, Subscription):
        return f"its subscription to {entity.topic_name}"
    if isinstance(entity, Service):
        return f"its service {entity.srv_name}"
    if isinstance(entity, Client):
        return f"its client of {entity.srv_name}"
    if isinstance(entity, ActionServer | ActionClient):
        return "its action server" if isinstance(entity, ActionServer) else "its action client"
    return "a task" if entity is None else f"its {type(entity).__name__}"


def _last_line(error: BaseException) -> str:
    text = str(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _is_milestone(count: int) -> bool:
    """Return True for 10, 100, 1000 and so on."""
    return count >= 10 and str(count).strip("0") == "1"
