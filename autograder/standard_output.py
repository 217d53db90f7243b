"""Standard output: kept free for results while Fast DDS prints its warnings there, and read however long its lines are.

Fast DDS writes its log to standard output (StdoutConsumer in fastdds/dds/log). One such line between two lines of JSON
makes them unreadable, and it comes only when something rare happens.
"""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from typing import IO, TYPE_CHECKING, BinaryIO

if TYPE_CHECKING:
    from collections.abc import Iterator

STDOUT = 1
STDERR = 2


def private_stdout() -> BinaryIO:
    """Standard output as a stream for results. From now on, all else that is printed goes to standard error."""
    sys.stdout.flush()
    results = os.fdopen(os.dup(STDOUT), "wb")
    os.dup2(STDERR, STDOUT)
    return results


@contextmanager
def stray_lines_on_stderr() -> Iterator[None]:
    """Send to standard error what libraries and child processes print to standard output in the meantime."""
    sys.stdout.flush()
    kept = os.dup(STDOUT)
    os.dup2(STDERR, STDOUT)
    try:
        yield
    finally:
        os.dup2(kept, STDOUT)
        os.close(kept)


def short_lines(stream: IO[bytes], limit: int) -> Iterator[bytes]:
    """The lines of a stream as they come, each with its end; of a longer one only the beginning.

    Args:
        stream: What is read to its end.
        limit: Bytes of a line that are given.
    """
    begins = True
    while piece := stream.readline(limit):
        if begins:
            yield piece
        begins = piece.endswith(b"\n")
