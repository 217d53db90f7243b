"""The exit to the terminal, which escapes what a student may have written; and output of programs, with limits.

Whatever a command prints, a student's text must not move the cursor, color or reverse a line, or begin another line. So
:func:`guard_terminal` makes the streams of the process escape everything but line ends, whoever prints: a command,
click, or a warning. :func:`printable` also escapes line ends, for a text that is a single line.

Standard output is also kept free for results. Fast DDS writes its log to standard output (StdoutConsumer in
fastdds/dds/log). A line of this log between two lines of JSON would keep a program from reading the JSON.
"""

from __future__ import annotations

import io
import json
import os
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, AnyStr, BinaryIO, Protocol, TextIO

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rich.console import Console
    from rich.segment import Segment

_STDOUT, _STDERR = 1, 2


def printable(text: str) -> str:
    """Return ``text`` with escapes for characters that are not printable, such as newlines and terminal codes."""
    return text if text.isprintable() else "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def printable_json(text: str) -> str:
    """Return equivalent JSON in which characters that are not printable, such as terminal codes, are escaped.

    Args:
        text: JSON on a single line.
    """
    return "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in text)


def printable_lines(text: str) -> str:
    """Return ``text`` with escapes for characters that are not printable, except line ends."""
    return "\n".join(map(printable, text.split("\n")))


class _GuardedStream(io.TextIOWrapper):
    """A stream to the terminal that escapes every text.

    Attributes:
        rich_proxied_file: The stream without escapes, to which rich writes by itself if it finds this attribute.
    """

    def __init__(self, stream: TextIO) -> None:
        super().__init__(stream.buffer, stream.encoding, "backslashreplace", write_through=True)
        self.rich_proxied_file = stream

    def write(self, text: str) -> int:
        super().write(printable_lines(text))
        return len(text)


def guard_terminal() -> None:
    """Make the standard streams of this process escape everything but line ends."""
    sys.stdout, sys.stderr = (
        stream and _GuardedStream(styled(stream)) for stream in (sys.stdout, sys.stderr)
    )


def styled(stream: TextIO) -> TextIO:
    """Return a stream for text with styles of our own, in which the parts of students are escaped already."""
    return getattr(stream, "rich_proxied_file", stream)


def console(*, stderr: bool = False) -> Console:
    """Return a console of rich that escapes every text, but not rich's own styles and movements of the cursor."""
    from rich.console import Console

    class GuardedConsole(Console):
        def render(self, renderable: Any, options: Any = None) -> Iterator[Segment]:
            for segment in super().render(renderable, options):
                yield segment if segment.control else segment._replace(text=printable_lines(segment.text))

    return GuardedConsole(stderr=stderr)


def private_stdout() -> BinaryIO:
    """Return standard output as a stream for results. From now on, all other output goes to standard error."""
    sys.stdout.flush()
    results = os.fdopen(os.dup(_STDOUT), "wb")
    os.dup2(_STDERR, _STDOUT)
    return results


@contextmanager
def stray_lines_on_stderr() -> Iterator[None]:
    """During a ``with`` block, redirect the standard output of libraries and child processes to standard error."""
    sys.stdout.flush()
    kept = os.dup(_STDOUT)
    os.dup2(_STDERR, _STDOUT)
    try:
        yield
    finally:
        os.dup2(kept, _STDOUT)
        os.close(kept)


class Chunks(Protocol):
    """A stream that returns available data without waiting for more."""

    def read1(self, size: int, /) -> bytes:
        """Return at most ``size`` bytes; b"" at the end of the stream."""


def split_lines(text: AnyStr) -> list[AnyStr]:
    """Return the lines of a text without their line ends. The last line may be incomplete.

    A carriage return ends a line, too, because a program may write the same line of a terminal repeatedly. A carriage
    return at the end of the text may be the first half of a line end (CR LF), so it stays in the last line.
    """
    end: Any
    back: Any
    end, back = ("\n", "\r") if isinstance(text, str) else (b"\n", b"\r")
    *lines, rest = text.replace(back + end, end).split(end)
    begun = rest.removesuffix(back)
    *pieces, last = begun.split(back)
    return [*(piece for line in lines for piece in line.split(back)), *pieces, last + rest[len(begun) :]]


def short_lines(stream: Chunks, limit: int) -> Iterator[bytes]:
    """Yield the lines of a stream as they arrive, each with its line end. A longer line is cut to the limit.

    A carriage return ends a line, as in :func:`split_lines`.

    Args:
        stream: The stream, which is read to its end.
        limit: The maximum length of a line in bytes.
    """
    rest, begins = b"", True
    while chunk := stream.read1(65_536):
        lines = (rest + chunk).splitlines(keepends=True)
        # A carriage return at the end of the data may be the first half of a line end.
        rest = b"" if lines[-1].endswith(b"\n") else lines.pop()
        for line in lines:
            if begins:
                yield line[:limit]
            begins = True
        if len(rest) >= limit:
            if begins:
                yield rest[:limit]
            # The last byte is kept for the next read: it may be \r, and only the next byte shows whether the line ends.
            rest, begins = rest[-1:], False
    if rest and begins:
        yield rest


LOOK_EVERY = 0.5
"""Seconds between two checks whether the output of a program is still needed."""


class Readable(Protocol):
    """A program whose output can be read."""

    def read(self, within: float, /) -> bytes | None:
        """Return the output since the last call; None if there is none within these seconds, b"" at the end."""


@dataclass(frozen=True)
class Collected:
    """The output of a program, from its start.

    Attributes:
        output: The output, cut to the maximum number of bytes.
        cut: True if there was more output.
        ended: True if the output has ended; False if reading was stopped before.
        late: True if reading was stopped at the time limit.
    """

    output: bytes
    cut: bool
    ended: bool
    late: bool = False


def collect(
    program: Readable, limit: float, size: int, unwanted: Callable[[], bool] = lambda: False
) -> Collected:
    """Read the output of a program until it ends or is no longer needed.

    Args:
        limit: Time limit in seconds of wall time, from now.
        size: The maximum number of bytes to keep.
        unwanted: Called from time to time. If it returns True, reading stops.
    """
    output, cut = bytearray(), False
    deadline = time.monotonic() + limit
    while (data := program.read(max(0.0, min(LOOK_EVERY, deadline - time.monotonic())))) != b"":
        room = size - len(output)
        output += (data or b"")[:room]
        cut = cut or len(data or b"") > room
        if (late := time.monotonic() > deadline) or unwanted():
            return Collected(bytes(output), cut, ended=False, late=late)
    return Collected(bytes(output), cut, ended=True)
