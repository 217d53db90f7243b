"""Reports to the judge what a subject logs and prints during a check, and when it looks for a server or calls one.

Output is reported instead of printed below the cell. Only the output of threads that started during the check is
captured, so a demonstration node that still runs in the background is not taken for the subject. Text that the subject
writes to the kernel's original streams is captured, too. A subject may have kept such a stream from before the check,
for example with ``from sys import stdout`` or in a handler of Python's ``logging``.

If the subject calls ``input()``, it gets an EOFError, like a program without a terminal. Otherwise JupyterLab would
show an input box, and no other cell could run until the student had answered.

Calls are reported because the judge cannot see from outside the kernel that a subject queries the graph. Nor can it see
a request that was sent before the judge's server existed, because such a request is lost.
"""

from __future__ import annotations

import functools
import linecache
import os
import sys
import threading
import traceback
from contextlib import suppress
from inspect import getattr_static
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import TYPE_CHECKING, Any, Self

from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node

from autograder.messages.judge_messages import Called, Looked
from autograder.notebook.cell_output import is_students, notebook_shell
from autograder.notebook.checking.judge_link import MAX_TEXT
from autograder.own_lines import loop_around
from autograder.standard_output import split_lines

if TYPE_CHECKING:
    from collections.abc import Callable


_COURSE = f"{Path(__file__).parents[2]}/"
"""The folder of this package. The stacks leave its calls out, because no student wrote them."""
_PLAIN = (int, float, str, bytes, type(None))
"""The types of values that nothing changes, except who sets their name."""
MOST_CALLS = 50
"""The maximum number of innermost calls of a thread that its stack shows, and of outermost ones behind them."""


class CapturedOutput:
    """Forwards the subject's output to the judge inside a ``with`` block, and restores the streams at the end."""

    def __init__(self, tell: Callable[[str, bool], None]) -> None:
        """Set up capturing. Entering the ``with`` block starts it.

        Args:
            tell: Called with each line, and with True if the line was logged, False if it was printed.
        """
        self._tell = tell
        self._others = {thread.ident for thread in threading.enumerate()}
        self._descriptors: list[tuple[int, int]] = []

    def __enter__(self) -> Self:
        self._usual_log = RcutilsLogger.log
        self._usual_streams = (sys.stdout, sys.stderr)
        usual_log: Any = self._usual_log
        captured = self.is_captured

        def log(logger: RcutilsLogger, message: Any, severity: Any, **options: Any) -> bool:
            # The logger's level or a filter such as `once` drops some lines: no terminal shows them.
            shown = bool(usual_log(logger, message, severity, **options))
            if shown and captured():
                self._tell(str(message)[:MAX_TEXT], True)
            return shown

        setattr(RcutilsLogger, "log", log)  # noqa: B010  (mypy forbids to assign to a method)
        self._streams = [_CapturedStream(stream, self._tell, captured) for stream in self._usual_streams]
        sys.stdout, sys.stderr = self._streams
        self._silence_compiled_code()
        self._kernel = getattr(notebook_shell(), "kernel", None)
        if self._kernel is not None:
            self._kernel._input_request = _no_input_for(captured, self._kernel._input_request)
        return self

    def __exit__(self, *_: object) -> None:
        if self._kernel is not None:
            del self._kernel._input_request
        setattr(RcutilsLogger, "log", self._usual_log)  # noqa: B010
        # sys.stdout and sys.stderr may be the same object: restore the last replacement first.
        for stream in reversed(self._streams):
            stream.finish()
        sys.stdout, sys.stderr = self._usual_streams
        while self._descriptors:
            descriptor, saved = self._descriptors.pop()
            os.dup2(saved, descriptor)
            os.close(saved)

    def stacks(self) -> tuple[str, float]:
        """Return the stacks of the subject's threads, innermost call first, in the form of Python's faulthandler.

        A thread of the course that is between two callbacks is left out: it seems to run no callbacks at all. The head
        of a thread also names the innermost loop of the student's code. The second value is the processor time
        in seconds that the busiest thread in the student's code has used; 0.0 if there is no such thread.
        """
        frames = sys._current_frames()
        lines, times = [], [0.0]
        for thread in threading.enumerate():
            if thread.ident in self._others or thread.ident not in frames:
                continue
            every = list(traceback.walk_stack(frames[thread.ident]))
            calls = [call for call in every if not call[0].f_code.co_filename.startswith(_COURSE)]
            is_ours = len(calls) < len(every)
            calls = [*calls[:MOST_CALLS], *calls[MOST_CALLS:][-MOST_CALLS:]]
            # A recursion has hundreds of calls at one line.
            own = {
                (call[0].f_code, call[1]): call for call in calls if is_students(call[0].f_code.co_filename)
            }
            if is_ours and not own and not any("/rclpy/" in call[0].f_code.co_filename for call in calls):
                continue  # between two callbacks
            times += [_processor_time(thread)] if own else []
            loop = next(filter(None, map(_loop_in, own.values())), "")
            lines.append(f"Thread {thread.ident:#x}{loop} (most recent call first):")
            lines += [
                f'  File "{frame.f_code.co_filename}", line {line} in {frame.f_code.co_name}'
                for frame, line in calls
            ]
        return "\n".join(lines), max(times)

    def is_captured(self) -> bool:
        """Return True if the calling thread belongs to the subject, that is, if it started during the check."""
        return threading.get_ident() not in self._others

    def _silence_compiled_code(self) -> None:
        # Discard the log lines that rcutils writes directly to file descriptors 1 and 2. The card shows the important
        # lines.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for descriptor in (1, 2):
            self._descriptors.append((descriptor, os.dup(descriptor)))
            os.dup2(nowhere, descriptor)
        os.close(nowhere)


def _loop_in(call: tuple[FrameType, int]) -> str:
    """Return words that quote the innermost loop of a call; empty if there is none."""
    frame, line = call
    text = "".join(linecache.getlines(frame.f_code.co_filename))
    found = loop_around(text, line, _fixed(frame))
    return f" in the loop of line {found}" if found else ""


def _fixed(frame: FrameType) -> frozenset[str]:
    """Return the plain variables of a call, and the plain attributes of its object that only this method names.

    The constructor may name them, too, but no function in it.
    """
    code = frame.f_code
    plain = {name for name, value in frame.f_locals.items() if isinstance(value, _PLAIN)}
    owner = next(iter(code.co_varnames[: code.co_argcount]), "")
    this = frame.f_locals.get(owner)
    members = [one for kind in type(this).__mro__ for one in vars(kind).items()]
    methods = [(name, one.__code__) for name, one in members if isinstance(one, FunctionType)]
    named = {name for name, _ in members}
    for name, method in methods:
        is_own = name == "__init__" or method is code
        named = named.union(*map(_named_in, method.co_consts if is_own else [method]))
    if any(method is code for _, method in methods):
        unnamed = {*code.co_names} - named
        plain |= {
            f"{owner}.{name}" for name in unnamed if isinstance(getattr_static(this, name, this), _PLAIN)
        }
    return frozenset(plain - {*code.co_freevars})


def _named_in(code: object) -> set[str]:
    """Return the names of variables and attributes in a function's code, and in functions inside of it."""
    if not isinstance(code, CodeType):
        return set()
    return set(code.co_names).union(*map(_named_in, code.co_consts))


def _processor_time(thread: threading.Thread) -> float:
    """Return the processor time in seconds that a thread of this process has used; 0.0 if it has ended (proc(5))."""
    with suppress(OSError):
        stat = Path(f"/proc/self/task/{thread.native_id}/stat").read_text(encoding="utf-8", errors="replace")
        user, system = stat.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
    return 0.0


def _no_input_for(captured: Callable[[], bool], usual: Callable[..., str]) -> Callable[..., str]:
    """Return the function behind ``input()`` and ``getpass()``, changed to raise EOFError in the subject's threads."""

    def ask(*arguments: Any, **options: Any) -> str:
        if captured():
            raise EOFError("EOF when reading a line")  # the text of Python's own EOFError
        return usual(*arguments, **options)

    return ask


class _CapturedStream:
    """Replaces sys.stdout or sys.stderr, and also receives text that is written to the original stream object.

    Lines of the subject's threads go to the judge. Lines of all other threads are written as usual.
    """

    def __init__(self, stream: Any, tell: Callable[[str, bool], None], captured: Callable[[], bool]) -> None:
        self._stream = stream
        self._usual_write = stream.write
        self._own_write = getattr(stream, "__dict__", {}).get("write")
        self._tell = tell
        self._captured = captured
        self._rest = ""
        self._lock = threading.Lock()
        with suppress(AttributeError):  # a student's own stream class may forbid this assignment
            stream.write = self.write

    def write(self, text: str) -> int:
        """Forward each line to the judge once it is complete."""
        if not self._captured():
            written: int = self._usual_write(text)
            return written
        with self._lock:
            *lines, rest = split_lines(self._rest + text)
            self._rest = rest[:MAX_TEXT]
        for line in lines:
            self._tell(line[:MAX_TEXT], False)
        return len(text)

    def finish(self) -> None:
        """Restore the original stream. Forward the last line, even if its line end is missing."""
        with suppress(AttributeError):
            if self._own_write is None:
                del self._stream.write
            else:
                self._stream.write = self._own_write
        with self._lock:
            rest, self._rest = self._rest, ""
        if rest:
            self._tell(rest.rstrip("\r"), False)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


TOLD: tuple[tuple[Any, str, type[Looked | Called]], ...] = (
    (Node, "get_service_names_and_types", Looked),
    (Node, "get_service_names_and_types_by_node", Looked),
    (Client, "service_is_ready", Looked),
    (ActionClient, "server_is_ready", Looked),
    (Client, "call_async", Called),
    (ActionClient, "send_goal_async", Called),
)
"""The methods whose calls are reported, each with the message that reports a call. rclpy's blocking methods, such as
``wait_for_service`` and ``call``, use these methods, too.
"""
LOOKS_TOLD = 10
"""How often per run the judge is told, at most, that the subject looks for a server. A loop without a pause looks
thousands of times a second.
"""


class ToldCalls:
    """Reports the subject's calls of the methods in :data:`TOLD` to the judge, within a ``with`` block."""

    def __init__(self, is_subject: Callable[[], bool], tell: Callable[..., None]) -> None:
        """Set up reporting. Entering the ``with`` block starts it.

        Args:
            is_subject: Returns True if the calling thread belongs to the subject.
            tell: Sends the judge a message about this run, given the message's class and fields.
        """
        self._is_subject = is_subject
        self._tell = tell
        self._looks = 0

    def begin_run(self) -> None:
        """Reset the counter that :data:`LOOKS_TOLD` limits. Call this before each run."""
        self._looks = 0

    def __enter__(self) -> Self:
        self._usual = [(owner, name, getattr(owner, name)) for owner, name, _ in TOLD]
        for owner, name, kind in TOLD:
            setattr(owner, name, self._told(getattr(owner, name), kind))
        return self

    def __exit__(self, *_: object) -> None:
        for owner, name, method in self._usual:
            setattr(owner, name, method)

    def _told(self, method: Callable[..., Any], kind: type[Looked | Called]) -> Callable[..., Any]:
        @functools.wraps(method)
        def told(*arguments: Any, **options: Any) -> Any:
            answer = method(*arguments, **options)
            if self._is_subject():
                self._looks += kind is Looked
                if kind is Called or self._looks <= LOOKS_TOLD:
                    self._tell(kind)
            return answer

        return told
