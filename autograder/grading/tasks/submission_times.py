"""Reads the submission time from nbgrader's timestamp file, which a student may have forged."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import STATE_NAME, TIMESTAMP, timestamp_text
from autograder.grading.collecting.collected_files import CollectedRecords
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from pathlib import Path


SECRET = "submission_secret.txt"
"""The name of a file that nbgrader's exchange writes next to collected notebooks. From this file, nbgrader knows to
which student a feedback page belongs.
"""
_MAX_BYTES = 200
_HEX = frozenset("0123456789abcdef")
_EARLIEST = datetime(2024, 5, 23)
"""The earliest accepted time: the release day of ROS 2 Jazzy."""
_MAX_AHEAD = timedelta(days=1)
"""The maximum time by which a submission time may be later than this machine's clock. The submission time may come from
another machine, whose clock differs.
"""


def read_timestamp(folder: Path) -> str:
    """Return the submission time as text, from the timestamp file; empty if no ordinary file has that name.

    But in a class that uses ``./course collect``, return the time that this command recorded, because the file may come
    from the student.
    """
    records = CollectedRecords(folder.parent.parent.parent / STATE_NAME)
    if records.is_used:
        history = records.get(folder.name, folder.parent.name)
        return timestamp_text(history.when) if history and history.when else ""
    return _text(folder / TIMESTAMP) or ""


def _text(path: Path) -> str | None:
    """Return the text of a short file; None if it cannot be read."""
    try:
        return read_bytes(path, most=_MAX_BYTES).decode("ascii", "replace").strip()
    except UnreadableSubmission:
        return None


def companions(folder: Path) -> dict[str, bytes]:
    """Return the contents of the files that nbgrader copies from a submission to ``autograded`` and ``feedback``.

    Without these files, `nbgrader release_feedback` would not know to which student a feedback page belongs.
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
    """Return True if the timestamp file is ignored, because ``./course collect`` recorded a different time."""
    records = CollectedRecords(folder.parent.parent.parent / STATE_NAME)
    if not records.is_used or not (folder / TIMESTAMP).exists():
        return False
    return _text(folder / TIMESTAMP) != read_timestamp(folder)


def handed_in_at(folder: Path, *, believed: datetime | None = None) -> datetime | None:
    """Return the submission time of a submission, in UTC; None if it is unknown.

    Args:
        folder: The folder of the submission.
        believed: A time that was accepted earlier, such as the time in the gradebook, and is therefore not checked
            against this machine's clock again.

    Raises:
        ValueError: The recorded text is not a time, or the time is impossible: in the future, or before ROS 2 Jazzy.
    """
    stamp = read_timestamp(folder)
    if not stamp:
        return None
    from nbgrader.utils import (
        parse_utc,
    )  # imported here because the import takes half a second, and few classes need it

    try:
        at: datetime = parse_utc(stamp)
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{folder / TIMESTAMP} does not contain a time: {stamp[:60]!r}") from error
    if at != believed and not _EARLIEST <= at <= datetime.now(tz=UTC).replace(tzinfo=None) + _MAX_AHEAD:
        raise ValueError(
            f"{folder / TIMESTAMP} contains {stamp[:60]}, which is in the future or before this course existed: "
            "write the right time into the file, or remove the file"
        )
    return at
