"""When a submission was handed in: nbgrader's file of that, read without trusting it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nbgrader.utils import parse_utc

from autograder.grading.submission import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

TIMESTAMP = "timestamp.txt"
"""The file's name, beside the notebooks."""
_LONGEST = 200


def read_timestamp(folder: Path) -> str:
    """What is written in the file; empty where there is none, or where it is no ordinary file."""
    try:
        return read_bytes(folder / TIMESTAMP, most=_LONGEST).decode("ascii", "replace").strip()
    except UnreadableSubmission:
        return ""


def handed_in_at(folder: Path) -> datetime | None:
    """When the work in a folder was handed in, in UTC; None where nobody wrote it down.

    Raises:
        ValueError: What was written down is no time.
    """
    stamp = read_timestamp(folder)
    try:
        at: datetime | None = parse_utc(stamp) if stamp else None
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{folder / TIMESTAMP} holds no time: {stamp[:60]!r}") from error
    return at
