"""Reading what a program prints, line by line, however long its lines are."""

from __future__ import annotations

from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


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
