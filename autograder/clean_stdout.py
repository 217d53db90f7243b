"""Standard output for results alone: Fast DDS prints its warnings there, in the middle of what a program is to read.

Fast DDS writes its log to standard output (StdoutConsumer in fastdds/dds/log). One such line between two lines of JSON
makes them unreadable, and it comes only when something rare happens.
"""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

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
