"""Writes the output of cells: text from any thread, and tracebacks with the student's own lines only.

Tracebacks are shortened because ten frames of rclpy do not help a student to find a typo.
"""

from __future__ import annotations

import builtins
import difflib
import importlib
import linecache
import os
import sys
import sysconfig
import threading
import traceback
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import rclpy

if TYPE_CHECKING:
    from types import FrameType


_SYNCHRONOUS_IDLE = "\x16"
"""The character that :func:`let_log_lines_arrive` writes to the pipe: SYN, which terminals ignore. The character is a
single byte, so it is never split between two reads.
"""
_ARRIVAL_LIMIT = 1.0
"""Time limit in seconds for that character to arrive."""
_one_at_a_time = threading.Lock()


def say(text: str) -> None:
    """Print a text below the cell that runs now; if no cell runs, below the one that ran last.

    The text goes to standard output, because nbgrader without this package gives no points to a graded cell that wrote
    to standard error.
    """
    # While a kernel shuts down, its streams are closed, and the text is dropped.
    with suppress(OSError, ValueError):
        print(text, flush=True)


def let_log_lines_arrive() -> None:
    """Wait until the log lines written so far are in the output of the running cell.

    rclpy's compiled code writes log lines to file descriptor 1. In a kernel, this descriptor is a pipe, and a thread of
    ipykernel copies its data to ``sys.stdout``. On a busy machine the last lines would arrive after the end of the
    cell, and nbclient would drop them. So this function writes one more character to the pipe, waits until the
    character arrives at ``sys.stdout``, and removes it there.
    """
    stream: Any = sys.stdout
    descriptor = getattr(stream, "_original_stdstream_fd", None)
    if descriptor is None or not getattr(stream, "_should_watch", False):
        return
    arrived = threading.Event()
    with _one_at_a_time:
        # Another library may have set the stream's own write. Remember it, because deleting it would undo that
        # library's work.
        plain_write = stream.write
        replaced = vars(stream).get("write")

        def write(text: str) -> Any:
            taken: Any = plain_write(text.replace(_SYNCHRONOUS_IDLE, ""))
            if _SYNCHRONOUS_IDLE in text:
                arrived.set()
            return taken

        stream.write = write
        try:
            os.write(descriptor, _SYNCHRONOUS_IDLE.encode())
            arrived.wait(_ARRIVAL_LIMIT)
        finally:
            if replaced is None:
                del stream.write
            else:
                stream.write = replaced


def _library_folders() -> tuple[str, ...]:
    """Return the folders of code that no student wrote: Python's, those of ROS, and this package's."""
    schemes = sysconfig.get_paths()
    folders = {schemes[name] for name in ("stdlib", "platstdlib", "purelib", "platlib")}
    folders.add(str(Path(rclpy.__file__).parent.parent))
    folders.add(str(Path(__file__).parent))
    # If ROS is installed system-wide, message packages may be in other folders than rclpy.
    folders.update(
        prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(":") if "/opt/ros" in prefix
    )
    return tuple(folder.rstrip("/") + "/" for folder in folders)


_LIBRARIES = _library_folders()


def is_students(filename: str) -> bool:
    """Return True if the code in a file was written by the student. A notebook's cell counts as a file, too."""
    return not filename.startswith("<frozen") and not filename.startswith(_LIBRARIES)


def student_frames(trace: TracebackType | None) -> TracebackType | None:
    """Return a traceback without frames of Python, ROS and this package; None if no frame is left."""
    frames = []
    while trace is not None:
        if is_students(trace.tb_frame.f_code.co_filename):
            frames.append(trace)
        trace = trace.tb_next
    kept: TracebackType | None = None
    for frame in reversed(frames):
        kept = TracebackType(kept, frame.tb_frame, frame.tb_lasti, frame.tb_lineno)
    return kept


def last_student_line(error: BaseException) -> tuple[str, int] | None:
    """Return the file and line of the student's code that raised the error; None if there is none."""
    trace = student_frames(error.__traceback__)
    if trace is None:
        return None
    while trace.tb_next is not None:
        trace = trace.tb_next
    return trace.tb_frame.f_code.co_filename, trace.tb_lineno


def render(error: BaseException) -> list[str]:
    """Return the lines of an error's traceback in the notebook's format, with only the student's code."""
    trace = student_frames(error.__traceback__)
    shell = notebook_shell()
    if shell is not None:
        lines: list[str] = shell.InteractiveTB.structured_traceback(type(error), error, trace, tb_offset=0)
        return lines
    return [line.rstrip("\n") for line in traceback.format_exception(type(error), error, trace)]


def notebook_shell() -> Any:
    """Return IPython's shell; None if this process is neither a kernel nor IPython."""
    ipython = sys.modules.get("IPython")
    return ipython.get_ipython() if ipython is not None else None


class PlainlyShownError(Exception):
    """An error whose traceback in a notebook shows only the student's code."""

    def _render_traceback_(self) -> list[str]:
        """Return the traceback's lines; IPython calls this instead of its own formatting."""
        return render(self)


_COUNTS = "get_line_number_of_frame"
"""The name of a function in ``IPython.core.ultratb``, which counts the lines of a frame's file."""


def point_at_raising_lines() -> None:
    """Make the arrow in IPython's tracebacks point at the line that raised the error, even if a ``finally`` follows.

    IPython finds the line of a frame in two ways: a precise one for short files, and a faster one for long files. The
    faster way shows the line that the frame ran last, which is in the ``finally`` block if there is one (Python's data
    model, "Traceback objects"). IPython 9 treats each cell as a long file, because it cannot read a cell's lines from a
    file. This function makes IPython count the cell's lines. Outside IPython it does nothing.
    """
    if notebook_shell() is None:
        return
    tracebacks: Any = importlib.import_module("IPython.core.ultratb")
    count = getattr(tracebacks, _COUNTS, None)
    # Each further call would wrap the function once more.
    if count is None or getattr(count, "knows_cells", False):
        return

    def lines_of(frame: FrameType) -> int:
        try:
            return int(count(frame))
        except OSError:
            lines = linecache.getlines(frame.f_code.co_filename, frame.f_globals)
            if not lines:
                raise
            return len(lines)

    lines_of.knows_cells = True  # type: ignore[attr-defined]
    setattr(tracebacks, _COUNTS, lines_of)


_NEAR = 0.75
"""The minimum similarity of two names, from 0 to 1, for a suggestion. For ``sefl`` and ``self`` it is 0.75."""


def meant_name(error: BaseException, trace: TracebackType | None) -> str:
    """Return a text such as ``. Did you mean: 'command'?``; empty if no name is similar or Python itself suggests one.

    From Python 3.12 on, ``traceback`` adds the suggestion. In Python 3.11 the interpreter adds it, but only if the
    error ends a program.

    Args:
        error: A NameError or an AttributeError; there is no suggestion for other errors.
        trace: The traceback of the error.
    """
    missing = getattr(error, "name", None)
    if sys.version_info >= (3, 12) or not missing or not isinstance(error, (NameError, AttributeError)):
        return ""
    if isinstance(error, AttributeError):
        known = _attributes(error.obj)
    else:
        while trace is not None and trace.tb_next is not None:
            trace = trace.tb_next
        local = trace.tb_frame.f_locals if trace is not None else {}
        # Python 3.12 also looks for a forgotten `self.` before it looks for similar names.
        if missing in _attributes(local.get("self")):
            return f". Did you mean: 'self.{missing}'?"
        known = [*local, *(trace.tb_frame.f_globals if trace is not None else {}), *dir(builtins)]
    public = [name for name in known if name[:1] != "_"]
    same = [name for name in public if name.lower() == missing.lower()]
    near = same or difflib.get_close_matches(missing, public, 1, _NEAR)
    return f". Did you mean: '{near[0]}'?" if near else ""


def _attributes(value: object) -> list[str]:
    """Return the names of a value's attributes, without calling a ``__dir__`` of its class."""
    return [*dir(type(value)), *getattr(value, "__dict__", {})]
