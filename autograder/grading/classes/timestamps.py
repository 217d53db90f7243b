"""The time of handing in, from nbgrader's timestamp file. A student may have forged that file."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import STATE_NAME
from autograder.grading.collecting.records import CollectedRecords
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from pathlib import Path

TIMESTAMP = "timestamp.txt"
"""The name of the timestamp file, which lies next to the notebooks."""
SECRET = "submission_secret.txt"
"""The name of the file that nbgrader's exchange writes next to collected notebooks. nbgrader uses it to decide which
student a feedback page is for.
"""
_LONGEST = 200
_HEX = frozenset("0123456789abcdef")
_EARLIEST = datetime(2024, 5, 23)
"""The earliest accepted time: the release day of ROS 2 Jazzy."""
_AHEAD = timedelta(days=1)
"""The maximum time by which a recorded time may be ahead of this machine's clock. It may come from another machine."""


def read_timestamp(folder: Path) -> str:
    """Return the text of the timestamp file; empty if it does not exist or is not an ordinary file.

    If ``./course collect`` collected the work, the file counts only if that command wrote it, because a student can
    include such a file in a submission.
    """
    records = CollectedRecords(folder.parent.parent.parent / STATE_NAME)
    if records.is_used:
        history = records.get(folder.name, folder.parent.name)
        return timestamp_text(history.when) if history and history.when else ""
    return _text(folder / TIMESTAMP) or ""


def _text(path: Path) -> str | None:
    """Return the text of a short file; None if it cannot be read."""
    try:
        return read_bytes(path, most=_LONGEST).decode("ascii", "replace").strip()
    except UnreadableSubmission:
        return None


def companions(folder: Path) -> dict[str, bytes]:
    """Return nbgrader's files that accompany a submission into ``autograded`` and ``feedback``, by name.

    Without these files, `nbgrader release_feedback` does not know which student a page is for.
    """
    found = {}
    stamp = read_timestamp(folder)
    if stamp:
        found[TIMESTAMP] = stamp.encode()
    secret = _text(folder / SECRET)
    if secret and _HEX.issuperset(secret):
        found[SECRET] = secret.encode()
    return found


def is_not_believed(folder: Path) -> bool:
    """Return True if a submission's timestamp file differs from the time that ``./course collect`` recorded."""
    records = CollectedRecords(folder.parent.parent.parent / STATE_NAME)
    if not records.is_used or not (folder / TIMESTAMP).exists():
        return False
    return _text(folder / TIMESTAMP) != read_timestamp(folder)


def timestamp_text(when: datetime) -> str:
    """Return a time in nbgrader's format.

    Args:
        when: A time in UTC.
    """
    return f"{when:%Y-%m-%d %H:%M:%S.%f} UTC"


def handed_in_at(folder: Path, *, believed: datetime | None = None) -> datetime | None:
    """Return the time at which the work in a folder was handed in, in UTC; None if no file records it.

    Args:
        folder: The folder of the submission.
        believed: A time that was accepted earlier, such as the one in the gradebook. It stays accepted even if this
            machine's clock is wrong today.

    Raises:
        ValueError: The text is not a time, or is a time at which no student can have handed in work.
    """
    stamp = read_timestamp(folder)
    if not stamp:
        return None
    from nbgrader.utils import (
        parse_utc,
    )  # imported here because it takes half a second, and few classes need it

    try:
        at: datetime = parse_utc(stamp)
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{folder / TIMESTAMP} does not contain a time: {stamp[:60]!r}") from error
    if at != believed and not _EARLIEST <= at <= datetime.now(tz=UTC).replace(tzinfo=None) + _AHEAD:
        raise ValueError(
            f"{folder / TIMESTAMP} says {stamp[:60]}, when no student can have handed in work for this course: "
            "write the right time into it, or remove it"
        )
    return at
