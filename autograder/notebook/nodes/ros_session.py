"""Starts ROS in a notebook's kernel, and keeps a list of the kernel's nodes, so that they can be destroyed.

ROS runs on a separate ROS domain, and is shut down when the kernel ends.

rclpy keeps no list of its nodes, and a forgotten node lives until Python collects it: a service from an earlier run
of a cell would go on answering requests. So this module records each new node with the run of the cell that made it.
"""

from __future__ import annotations

import atexit
import functools
import os
import shlex
import sys
import threading
import warnings
import weakref
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.exceptions import InvalidHandle, NotInitializedException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions, get_current_signal_handlers_options, uninstall_signal_handlers
from rclpy.task import Future
from rclpy.utilities import get_default_context, ok, try_shutdown

from autograder.dds_discovery import DOMAIN_VARIABLE, DomainClaim, claim_free_domain, domain_from_environment
from autograder.notebook.nodes.interrupts import end_waits_from_now_on
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.context import Context

    from autograder.notebook.cell_runs import TrackedRun


_CHECK_FIELDS = "ROS_PYTHON_CHECK_FIELDS"
_EXPLAIN = shlex.join(python_child("-m", "autograder.known_errors").command)

_DEFAULTS = {
    # Log to stdout, because nbgrader without this package gives no points to a graded cell that wrote to stderr.
    "RCUTILS_LOGGING_USE_STDOUT": "1",
    "RCUTILS_COLORIZED_OUTPUT": "0",
    # Write each line at once. Otherwise, if the kernel's output does not go to a terminal (in a batch, or on a
    # JupyterHub), the C library holds log lines back until there are 4 KB, and they appear below another cell or never.
    "RCUTILS_LOGGING_BUFFERED_STREAM": "1",
    # The same for what a Python program prints into a file while a cell waits for it.
    "PYTHONUNBUFFERED": "1",
    # Make messages raise an error if a field is set to a value of the wrong type.
    _CHECK_FIELDS: "1",
    # Make `colcon build` in a cell use the build type of a check, as environment/activate.sh does in a terminal.
    # Otherwise, a field of the wrong type would end a program instead of raising an exception.
    "CMAKE_BUILD_TYPE": "Release",
    # A function that bash inherits and calls if it does not find a command: it adds what is known about the command.
    "BASH_FUNC_command_not_found_handle%%": (
        f'() {{ echo "bash: $1: command not found" >&2; {_EXPLAIN} "$1"; return 127; }}'
    ),
}
_DISCOVERY_VARIABLES = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY")


@dataclass(frozen=True, repr=False)
class RosSession:
    """How ROS was started in this kernel.

    Attributes:
        domain: The ROS domain of the kernel's nodes.
        picked: True if ``start_ros`` chose the domain because ``ROS_DOMAIN_ID`` was not set.
    """

    domain: int
    picked: bool

    def __repr__(self) -> str:
        """Return one line, shown if this is the last expression of a cell."""
        line = f"ROS 2 is up on domain {self.domain}."
        if self.picked:
            line += f" To join it from a terminal: export {DOMAIN_VARIABLE}={self.domain}"
        return line


_lock = threading.RLock()
_claim: DomainClaim | None = None


def prepare_environment() -> None:
    """Set the environment variables that ROS needs in a notebook, unless the user has set them.

    With these variables, log lines go to standard output at once and without color codes, the types of message fields
    are checked, and discovery is limited to this computer. Processes that a cell starts inherit the variables.
    """
    for name, value in _DEFAULTS.items():
        os.environ.setdefault(name, value)
    if not any(os.environ.get(name) for name in _DISCOVERY_VARIABLES):
        os.environ[_DISCOVERY_VARIABLES[0]] = "LOCALHOST"
    if os.environ[_CHECK_FIELDS] == "1":
        _check_fields_of_imported_messages()


def _check_fields_of_imported_messages() -> None:
    """Switch on type checks in generated message modules that were imported before the variable was set.

    When such a module is imported, it copies the variable into a global, which the constructors of its messages read
    (``rosidl_generator_py/resource/_msg.py.em``). This function changes the global.
    """
    for module in list(sys.modules.values()):
        names = getattr(module, "__dict__", {})
        if names.get("ros_python_check_fields") == "":
            names["ros_python_check_fields"] = "1"


def start_ros() -> RosSession:
    """Start ROS in this kernel. If ROS already runs, change nothing. Return how ROS was started.

    The ROS domain is taken from ``ROS_DOMAIN_ID``. If this variable is not set, a free domain is chosen, reserved until
    the kernel ends, and written to the variable, so that processes started from the notebook use the same domain. ROS
    gets no signal handlers: interrupting the kernel stops the cell and not the nodes. After ``rclpy.shutdown()``, this
    function starts ROS again.

    Raises:
        ValueError: ``ROS_DOMAIN_ID`` is not a valid domain number.
        NoFreeDomainError: Every domain on this computer is in use.
    """
    with _lock:
        prepare_environment()
        if (
            threading.current_thread() is threading.main_thread()
        ):  # Python handles signals in this thread only
            end_waits_from_now_on()
        if ok():
            # Remove the signal handlers of an earlier rclpy.init(), because they would end ROS at an interrupt.
            if get_current_signal_handlers_options() != SignalHandlerOptions.NO:
                uninstall_signal_handlers()
        else:
            # If the default context was shut down, this makes rclpy create a new one.
            try_shutdown()
            rclpy.init(args=[], domain_id=_session_domain(), signal_handler_options=SignalHandlerOptions.NO)
        domain = get_default_context().get_domain_id()
        os.environ[DOMAIN_VARIABLE] = os.environ.get(DOMAIN_VARIABLE) or str(domain)
        return RosSession(domain=domain, picked=_claim is not None and _claim.domain == domain)


def _session_domain() -> int:
    global _claim
    domain = domain_from_environment()
    if domain is None:
        if _claim is None:
            _claim = claim_free_domain()
        domain = _claim.domain
    return domain


# This exit handler is registered before the one of background_nodes.py, so it runs after it: nodes end first, then ROS.
atexit.register(try_shutdown)


@dataclass(frozen=True)
class NodeIdentity:
    """The full name of a node, and its context.

    Attributes:
        name: The node's name with its namespace, such as ``"/robot/talker_node"``.
        context: The ROS context to which the node belongs.
    """

    name: str
    context: Context


@dataclass(frozen=True)
class KernelNode:
    """A node and the run of the cell that made it.

    Attributes:
        node: The node.
        identity: The full name of the node, and its ROS context.
        run: The run of the cell that made the node; None outside a notebook.
    """

    node: Node
    identity: NodeIdentity
    run: TrackedRun | None


class KernelNodes:
    """Records every node that is made from now on.

    Args:
        current_run: Returns the current run of a cell; None outside a notebook.
        before_making: Called with the identity of each node just before the node is made.
    """

    def __init__(
        self, current_run: Callable[[], TrackedRun | None], before_making: Callable[[NodeIdentity], None]
    ) -> None:
        self._current_run = current_run
        self._before_making = before_making
        self._lock = threading.Lock()
        self._made: list[tuple[weakref.ref[Node], NodeIdentity, TrackedRun | None]] = []

    def start_recording(self) -> None:
        """Start recording, by wrapping ``Node.__init__``: rclpy has no other hook for new nodes."""
        plain_init = Node.__init__

        @functools.wraps(plain_init)
        def init(node: Node, node_name: str, *args: Any, **kwargs: Any) -> None:
            __tracebackhide__ = True
            identity = _identity_to_be(node_name, kwargs)
            self._before_making(identity)
            self._note(node, identity)
            try:
                plain_init(node, node_name, *args, **kwargs)
            except NotInitializedException as error:
                error.add_note(
                    "ROS is not running in this notebook: call start_ros() before you make a node."
                )
                raise

        Node.__init__ = init  # type: ignore[method-assign, assignment]

    def _note(self, node: Node, identity: NodeIdentity) -> None:
        with self._lock:
            self._made = [entry for entry in self._made if entry[0]() is not None]
            self._made.append((weakref.ref(node), identity, self._current_run()))

    def alive(self) -> list[KernelNode]:
        """Return the nodes that are on the graph."""
        with self._lock:
            entries = [(reference(), identity, run) for reference, identity, run in self._made]
        return [
            KernelNode(node, identity, run)
            for node, identity, run in entries
            if node is not None and _has_begun(node)
        ]

    def on(self, context: Context) -> list[Node]:
        """Return all nodes of a context that are in memory, also destroyed ones and those whose ``__init__`` failed."""
        with self._lock:
            entries = [(reference(), identity) for reference, identity, _ in self._made]
        return [node for node, identity in entries if node is not None and identity.context is context]


def _identity_to_be(node_name: str, options: dict[str, Any]) -> NodeIdentity:
    """Return the identity of the node that ``Node.__init__`` will make from these arguments."""
    namespace = str(options.get("namespace") or "").strip("/")
    return NodeIdentity(
        name="/".join(["", *filter(None, [namespace]), str(node_name)]),
        context=options.get("context") or get_default_context(),
    )


def _has_begun(node: Node) -> bool:
    """Return True if the node is usable: not destroyed, and its ``__init__`` did not fail."""
    try:
        return not is_destroyed(node)
    except AttributeError:
        return False


class NodeEndedError(RuntimeError):
    """The node was destroyed, or ROS was shut down."""


def destroy_node(node: Node) -> None:
    """Destroy a node with its action servers and clients. If it is already destroyed, do nothing.

    ``Node.destroy_node`` does not destroy action servers and clients. As long as one of these lives, the node stays on
    the graph, and clients would still send it goals. Code that waits for an answer to a request of this node gets a
    ``NodeEndedError``, because the answer can no longer come.
    """
    release_waiting_calls(node)
    for waitable in _parts(node, "waitables"):
        if hasattr(waitable, "destroy"):
            with suppress(InvalidHandle):
                waitable.destroy()
    # A node whose __init__ failed lacks some of its attributes.
    with suppress(InvalidHandle, AttributeError):
        node.destroy_node()


def node_label(node: Any) -> str:
    """Return the node's name or, if the node is destroyed, the name of its class."""
    if node is None:
        return "a node"
    try:
        return str(node.get_name())
    except (InvalidHandle, AttributeError):  # the node is destroyed, or super().__init__() was never called
        return type(node).__name__


def is_destroyed(node: Node) -> bool:
    """Return True if the node was destroyed."""
    try:
        with node.handle:
            return False
    except InvalidHandle:
        return True


def is_being_destroyed(node: Node) -> bool:
    """Return True as soon as ``destroy_node`` was called, which drops this publisher first (rclpy, ``node.py``)."""
    return getattr(node, "_parameter_event_publisher", None) is None


_STOPPED = "was stopped while this call was waiting for its answer"


def release_waiting_calls(node: Node) -> None:
    """Make each call of this node that waits for an answer raise a ``NodeEndedError``."""
    error = NodeEndedError(f"{node_label(node)} {_STOPPED}")
    for future in _pending_answers(node):
        if not future.done():
            with warnings.catch_warnings():
                # A callback that waits for the answer gets this error, as intended. Suppress rclpy's warning about this
                # error.
                warnings.filterwarnings("ignore", f".* {_STOPPED}", UserWarning)
                future.set_exception(error)


def _stay_silent_about_ended_nodes(
    future: Future, ended: type[Exception] = NodeEndedError, say: Callable[[Future], None] = Future.__del__
) -> None:
    # The defaults are kept also when Python ends and clears the names of modules.
    if not isinstance(future._exception, ended):
        say(future)


# When a future is garbage-collected, rclpy writes an exception that was never read to stderr, in whichever cell runs.
# That of a callback is never read if an executor's pool still runs it after the student's spin has ended.
Future.__del__ = _stay_silent_about_ended_nodes  # type: ignore[method-assign]


def _pending_answers(node: Node) -> list[Future]:
    # Look into the dictionaries in which rclpy's clients keep the futures of the answers for which they wait
    # (rclpy/client.py, rclpy/action/client.py).
    return [
        future
        for client in (*_parts(node, "clients"), *_parts(node, "waitables"))
        for name, requests in vars(client).items()
        if name.startswith("_pending_") and isinstance(requests, dict)
        for future in list(requests.values())
        if isinstance(future, Future)
    ]


def _parts(node: Node, kind: str) -> list[Any]:
    """Return the node's ``clients`` or ``waitables``; an empty list if ``__init__`` failed before it made them."""
    try:
        return list(getattr(node, kind))
    except AttributeError:
        return []
