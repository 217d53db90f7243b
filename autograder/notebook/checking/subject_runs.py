"""One run of a subject: of a class or function in a thread of the kernel, or of a path in a separate process.

A node class is instantiated and spun, and a function is called. A workspace is built and its programs are run; a launch
file is launched.
"""

from __future__ import annotations

import hashlib
import inspect
import linecache
import os
import threading
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy._rclpy_pybind11 import InvalidHandle
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Empty

from autograder.messages.judge_messages import Constructed, OwnLines, Raised, Returned, Sources, Started
from autograder.messages.run_messages import Exited, Output
from autograder.messages.workspace_messages import Source
from autograder.notebook.cell_output import is_students, meant_name, student_frames
from autograder.notebook.cell_runs import functions_of, names_read
from autograder.notebook.checking.judge_link import MAX_TEXT
from autograder.notebook.nodes.spin_threads import SpinFailure, SpinThreads, raise_in_thread
from autograder.own_lines import own_lines, own_lines_of_files
from autograder.workspaces.jobs import output_lines
from autograder.workspaces.own_session import OwnSession
from autograder.workspaces.packages import workspace_of
from autograder.workspaces.sources import BadSources, collect_launch, collect_workspace
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from rclpy.context import Context

    from autograder.messages.json_lines import Message


Tell = Callable[["Message"], None]
"""A function that sends a message to the judge."""

END_LIMIT = 1.5
"""Time limit in seconds of wall time for the thread of a stopped subject to end."""


class SubjectRun:
    """Runs one subject once."""

    def __init__(self, number: int, subject: Any, context: Context, tell: Tell) -> None:
        self._number = number
        self._subject = subject
        self._context = context
        self._tell = tell
        self._released = threading.Event()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._live, name=f"subject {number}", daemon=True)
        self._spinning = False
        self._arguments: Sequence[Any] = ()
        self._options: Mapping[str, Any] = {}

    def start(self, arguments: Sequence[Any], options: Mapping[str, Any]) -> None:
        """Begin the run.

        Args:
            arguments: The arguments of the class or function.
            options: Keyword arguments for a function; those that it has no parameter for are left out. For a class,
                only ``threads`` is used, the number of threads that spin the node.
        """
        self._arguments, self._options = arguments, options
        self._thread.start()

    def release(self) -> None:
        """Spin the node, as soon as its constructor has returned."""
        self._released.set()

    def stop(self) -> bool:
        """End the run. Return True if the run's thread has ended."""
        self._stopping.set()
        self._released.set()
        self._thread.join(timeout=END_LIMIT if self._spinning else END_LIMIT / 5)
        if self._thread.is_alive() and self._thread.ident is not None:
            raise_in_thread(self._thread.ident, SystemExit)  # the student's code may be in an endless loop
            self._thread.join(timeout=END_LIMIT)
        return not self._thread.is_alive()

    def _live(self) -> None:
        others = set(threading.enumerate())
        try:
            if inspect.isclass(self._subject):
                self._tell(Started(self._number, []))
                self._spin(self._made(), others)
                return
            accepted = _accepted(self._subject, self._options)
            self._tell(Started(self._number, sorted(accepted)))
            value = self._subject(*self._arguments, **accepted)
            if isinstance(value, Node) and not self._arguments and _is_alive(value):
                self._spin(value, others)  # the student passed a function that makes the node
            else:
                self._tell(Returned(self._number, None if value is None else repr(value)[:MAX_TEXT]))
        except ExternalShutdownException:
            pass
        except BaseException as error:
            if not (self._stopping.is_set() and isinstance(error, SystemExit)):
                self._tell(Raised(self._number, student_traceback(error)))

    def _made(self) -> Node:
        node = self._subject(*self._arguments)
        if not isinstance(node, Node):
            raise TypeError(
                f"{self._subject.__name__} is not a Node: write class {self._subject.__name__}(Node)"
            )
        return node

    def _spin(self, node: Node, others: set[threading.Thread]) -> None:
        goes_on = any(node.timers) or not others.issuperset(threading.enumerate())
        name = node.get_name()
        twin = name if node.get_node_names().count(name) > 1 else ""
        self._tell(Constructed(self._number, _mark(node, self._number), goes_on, twin))
        self._released.wait()
        threads = SpinThreads(
            [node],
            threads=int(self._options.get("threads", 1)),
            on_failure=self._callback_raised,
            on_end=lambda _: self._stopping.set(),
        )
        self._spinning = True
        threads.start()
        self._stopping.wait()
        threads.stop(grace=END_LIMIT / 3)

    def _callback_raised(self, failure: SpinFailure) -> None:
        if self._stopping.is_set():
            return
        shown = student_traceback(failure.error)
        if isinstance(failure.entity, ActionServer) and student_frames(failure.error.__traceback__):
            # In a program, rclpy prints an exception of an execute callback, aborts the goal and goes on.
            for line in shown.splitlines():
                self._tell(Output(self._number, line))
            return
        # Report an exception in any other callback as the end of the subject, because it would also end rclpy.spin in
        # a program.
        self._tell(Raised(self._number, shown))


def _is_alive(node: Node) -> bool:
    try:
        node.get_name()
    except InvalidHandle:
        return False
    return True


UNREADABLE = (
    "Exception: an error that cannot be shown, because its class, text or cause raises an error itself"
)
"""The traceback of an error that ends whatever asks for its name or text."""


def student_traceback(error: BaseException) -> str:
    """Return an error's traceback with only the student's code, in the format of a terminal.

    If the error contains the errors of several callbacks, only the first of them is formatted. An error whose class,
    text or cause cannot be read has the text :data:`UNREADABLE`.
    """
    try:
        return _student_traceback(error)
    # Also what ends this thread: else the judge would wait for a constructor that has ended.
    except BaseException:
        trace = student_frames(vars(BaseException)["__traceback__"].__get__(error))
        return f"{''.join(traceback.format_tb(trace))}{UNREADABLE}"


def _student_traceback(error: BaseException) -> str:
    collected = getattr(error, "errors", ())
    if collected and isinstance(getattr(collected[0], "error", None), BaseException):
        error = collected[0].error
    trace = student_frames(error.__traceback__)
    shown = traceback.format_exception(type(error), error, trace)
    text = "".join(shown).strip() + meant_name(error, trace)
    # Cut out the middle: the beginning shows the line of the error, the end its type and message.
    return text if len(text) <= MAX_TEXT else f"{text[: MAX_TEXT // 2]}\n{text[-MAX_TEXT // 2 + 1 :]}"


def _mark(node: Node, number: int) -> str:
    """Create the marker, a publisher and a subscription. A process that sees them has seen all earlier endpoints."""
    name = f"/_ready_{number}"
    try:
        Node.create_publisher(node, Empty, name, 1)
        Node.create_subscription(node, Empty, name, lambda _: None, 1)
    except Exception:
        return ""
    return name


def _accepted(function: Any, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return those options for which the function has a parameter."""
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        return {}
    if any(p.kind is inspect.Parameter.VAR_KEYWORD for p in parameters.values()):
        return dict(options)
    return {name: value for name, value in options.items() if name in parameters}


POLITE = 1.5
"""Time limit in seconds of wall time for programs to end after an interrupt. Then they are killed."""


class PathRun:
    """Runs ``python -m autograder.workspaces PATH`` once, on the ROS domain of the check."""

    def __init__(
        self, number: int, exercise: str, path: str | os.PathLike[str], domain: int, tell: Tell
    ) -> None:
        self._number = number
        self._command = python_child("-m", "autograder.workspaces", exercise, os.fspath(path)).command
        self._domain = domain
        self._tell = tell
        self._program: OwnSession | None = None
        self._reader: threading.Thread | None = None

    def start(self, arguments: Sequence[Any], options: Mapping[str, Any]) -> None:
        """Start the process for one run.

        Args:
            arguments: If the exercise has several programs, the name of one and its arguments; otherwise nothing.
            options: Always empty, because only a function or a node has options.
        """
        del options
        environment = {
            **os.environ,
            "ROS_DOMAIN_ID": str(self._domain),
            "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
            "PYTHONUNBUFFERED": "1",
        }
        # The process gets its own session, so that an interrupt of the kernel does not end it. Only the judge ends it.
        self._program = OwnSession([*self._command, *map(str, arguments)], environment)
        self._reader = threading.Thread(target=self._follow, args=(self._program,), daemon=True)
        self._reader.start()

    def release(self) -> None:
        """Do nothing: a process runs on by itself after :meth:`start`. Only a node waits for this call."""

    def interrupt(self) -> None:
        """Send Ctrl-C to the process, as in a terminal."""
        if self._program is not None:
            self._program.interrupt()

    def stop(self) -> bool:
        """End the process and everything that it has started. Return True."""
        if self._program is not None:
            self._program.end(POLITE)
        if self._reader is not None:
            self._reader.join(timeout=POLITE)
        return True

    def _follow(self, program: OwnSession) -> None:
        with program:
            for text in output_lines(program, within=POLITE):
                self._tell(Output(self._number, text))
        self._tell(Exited(self._number, program.wait()))


def is_path(subject: object) -> bool:
    """Return True if a subject is a path: a string or a ``pathlib.Path``."""
    return isinstance(subject, (str, Path))


def own_lines_of(subject: object) -> OwnLines:
    """Return the lines of the student's code that a card may quote: of the subject and of all that it refers to."""
    if isinstance(subject, (str, Path)):
        return own_lines_of_files([Path(subject)] if Path(subject).is_dir() else [])
    return own_lines(_cells_of(subject))


def own_text(given: str, subject: object) -> str:
    """Return what a student has made of a given cell: the file that it writes, or the cell that defines the subject.

    Args:
        given: The text of the cell as it was given.
        subject: The argument of the check cell.
    """
    magic = given.partition("\n")[0]
    if not magic.startswith("%%"):
        return "" if isinstance(subject, (str, Path)) else next(iter(_cells_of(subject).values()), "")
    with suppress(OSError):
        return f"{magic}\n{Path(magic.split()[-1]).read_text(encoding='utf-8', errors='replace')}".rstrip()
    return ""


def _cells_of(subject: object) -> dict[str, str]:
    """Return the texts of the cells with the subject and with all that it refers to, the subject's first."""
    sources: dict[str, str] = {}
    waiting, done, files = [subject], set[int](), set[str]()
    for one in waiting:
        own = [] if id(one) in done else functions_of(one)
        done.add(id(one))
        for function in own:
            file = function.__code__.co_filename
            if not is_students(file):
                continue
            if file not in files:
                place = f"the cell with {getattr(one, '__name__', '')}" if sources else "your cell"
                sources[place] = "".join(linecache.getlines(file))
                files.add(file)
            waiting += [function.__globals__.get(name) for name in sorted(names_read(function))]
        waiting += getattr(one, "__bases__", ()) if own else ()
    return sources


def code_digest(subject: object) -> str:
    """Return a digest of the code that is checked, white space aside; empty if the code cannot be read."""
    if isinstance(subject, (str, Path)):
        try:
            texts = [source.data or b"" for source in _collected(subject)[1]]
        except (BadSources, OSError):
            return ""
    else:
        texts = [text.encode() for text in _cells_of(subject).values()]
    code = b"".join(b"".join(text.split()) for text in texts)
    return hashlib.sha256(code).hexdigest()[:16] if code else ""


def _collected(path: str | Path) -> tuple[str, list[Source]]:
    """Return all source files that a check of a workspace or launch file may need, and the path of this among them.

    Raises:
        BadSources: The sources are too large.
        OSError: The sources cannot be read.
    """
    file = Path(path)
    if file.suffix and not file.is_dir():
        return collect_launch(file, workspace_of(file, (file.resolve().parent, Path.cwd())))
    return file.resolve().name or "nothing", collect_workspace(file)


def send_sources(tell: Tell, subject: object) -> None:
    """Send the grader's judge all source files that a check of this workspace or launch file may need.

    Args:
        tell: Sends a message to the judge.
        subject: The argument of the check cell. Only a path has sources.
    """
    path, sent, trouble = "nothing", list[Source](), ""
    try:
        if not isinstance(subject, (str, Path)):
            raise BadSources(
                f"check(...) takes the path of a workspace or launch file here, not a {type(subject).__name__}"
            )
        path, sent = _collected(subject)
    except (BadSources, OSError) as error:
        trouble = str(error)
    for source in sent:
        tell(source)
    tell(Sources(path, trouble))
