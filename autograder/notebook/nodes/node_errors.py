"""Explains to a student what is wrong with a node: it cannot be spun, or one of its callbacks raised an exception.

The traceback of an exception is shown at the first time; after that, the exception is only counted.
"""

from __future__ import annotations

import inspect
import threading
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer
from rclpy.client import Client
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Timer

from autograder.notebook.cell_output import PlainlyShownError, last_student_line, render, say
from autograder.notebook.nodes.lending_executors import LendingExecutor
from autograder.notebook.nodes.ros_session import NodeEndedError, is_destroyed, node_label

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.notebook.nodes.spin_threads import SpinFailure


class NotANodeError(PlainlyShownError, TypeError):
    """An argument is not a node."""


class UnusableNodeError(PlainlyShownError, NodeEndedError):
    """The node was destroyed, ROS was shut down, or the node's ``__init__`` was not called."""


class NodeBusyError(PlainlyShownError, RuntimeError):
    """The node already spins."""


class SettingError(PlainlyShownError, ValueError):
    """An option, such as the number of threads, is not valid."""


def check_nodes(caller: str, nodes: tuple[Any, ...]) -> None:
    """Check that all nodes can be spun together.

    Args:
        caller: The name of the function that the student called, for the messages.
        nodes: The arguments of this call.

    Raises:
        NotANodeError: An argument is not a node, or there are no arguments.
        UnusableNodeError: A node was destroyed, ROS was shut down after it was made, or its ``__init__`` was skipped.
        NodeBusyError: A node already spins, or is given twice.
    """
    if not nodes:
        raise NotANodeError(f"{caller}() needs at least one node, such as {caller}(TalkerNode())")
    for node in nodes:
        _check_is_node(caller, node)
        _check_is_usable(node)
        _check_is_idle(node)
    if len({id(node) for node in nodes}) < len(nodes):
        raise NodeBusyError(f"{caller}() was given the same node twice: give each node once")
    if len({id(node.context) for node in nodes}) > 1:
        raise UnusableNodeError(
            "these nodes belong to different ROS contexts, and one executor serves only one context: "
            f"call {caller}() separately for the nodes of each context"
        )


def check_threads(threads: Any) -> None:
    """Check that a number of threads is valid.

    Raises:
        SettingError: The number is not a whole number of at least 1.
    """
    if not isinstance(threads, int) or isinstance(threads, bool) or threads < 1:
        raise SettingError(f"threads must be a whole number of at least 1, not {threads!r}")


def _check_is_node(caller: str, thing: Any) -> None:
    if isinstance(thing, Node):
        return
    if isinstance(thing, type):
        kind = "a class" if issubclass(thing, Node) else "a class that is not derived from Node"
        raise NotANodeError(
            f"{thing.__name__} is {kind}. Add parentheses to make a node of it: {caller}({thing.__name__}())"
        )
    if isinstance(thing, list | tuple | set):
        raise NotANodeError(
            f"{caller}() takes nodes one by one, not in a {type(thing).__name__}: "
            f"{caller}(TalkerNode(), ListenerNode()), or {caller}(*nodes)"
        )
    if inspect.isroutine(thing):
        raise NotANodeError(
            f"{thing.__name__} is a function. Call it, if it returns a node: {caller}({thing.__name__}())"
        )
    if thing is None:
        raise NotANodeError(
            f"{caller}() was given None. A function that makes a node must end with `return node`"
        )
    raise NotANodeError(
        f"{caller}() takes nodes, but this argument is of type {type(thing).__name__}: {thing!r}"
    )


def _check_is_usable(node: Node) -> None:
    kind = type(node).__name__
    try:
        destroyed = is_destroyed(node)
    except AttributeError:
        raise UnusableNodeError(
            f'{kind} is not initialized as a node: begin its __init__ with super().__init__("a_name")'
        ) from None
    if destroyed:
        raise UnusableNodeError(
            f"this {kind} has been destroyed (`with spinning(...)` and .stop() do that at their end). "
            f"Make a new one: {kind}()"
        )
    if not node.context.ok():
        raise UnusableNodeError(
            f"ROS was shut down after this {kind} had been made. "
            f"Call start_ros(), then make a new one: {kind}()"
        )


def _check_is_idle(node: Node) -> None:
    executor = node.executor
    if executor is None or node not in executor.get_nodes():
        return
    name = node_label(node)
    if isinstance(executor, LendingExecutor):
        raise NodeBusyError(
            f"{name} spins in the background already: let it spin, or first call .stop() on what spin_in_background() "
            "returned"
        )
    raise NodeBusyError(
        f"{name} is in another executor already ({type(executor).__name__}): "
        "end rclpy.spin() there, or call that executor's remove_node() first"
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
                seen = CallbackError(node_label(failure.node), _callback_owner(failure.entity), failure.error)
            else:
                seen = replace(known, count=known.count + 1)
            self._errors[key] = seen
        if known is None:
            say(_report(seen, failure))
        elif seen.count >= 10 and str(seen.count).strip("0") == "1":  # 10, 100, 1000 and so on
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
        lines.append(_last_line(seen.error))
        with suppress(InvalidHandle):  # its node was destroyed meanwhile
            lines += _hints(failure)
    else:
        lines += render(seen.error)
    if isinstance(seen.error, NodeEndedError):
        lines.append(
            "While a callback waits in call(), only another thread can take the answer: "
            "give the client its own callback group, and spin with threads=2."
        )
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


def _callback_owner(entity: Any) -> str:
    """Return the owner of a callback in words, such as ``its service /reset``."""
    try:
        return _owner_in_words(entity)
    except InvalidHandle:  # its node was destroyed meanwhile
        return f"its {type(entity).__name__.lower()}"


def _owner_in_words(entity: Any) -> str:
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
