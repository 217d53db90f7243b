"""Takes into the inbox the files that an older version of the course, which had no inbox, has collected, with times."""

from __future__ import annotations

import gzip
import hashlib
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.collecting.deciding.proposals import Edit
from autograder.grading.collecting.inbox import Arrival, Delivery
from autograder.grading.collecting.records import FOLDER, Collected, History
from autograder.grading.rebuilding.submission import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.inbox import Inbox


@dataclass(frozen=True)
class _Older(History):
    """A record with the notebooks that were replaced; their bytes are in a folder next to it."""

    before: tuple[Collected, ...] = ()


def take_over(directory: ClassDirectory, inbox: Inbox, edits: dict[str, Edit]) -> list[str]:
    """Take over the records of an older version, and return a sentence about it; empty if there are none.

    Args:
        directory: The class.
        inbox: Receives the bytes. A record whose bytes are in the inbox is skipped: it is new, or was taken over
            before.
        edits: Receives the students and the times, as if a person had entered them.

    Raises:
        OSError: The bytes could not be written.
    """
    by_form: dict[str, list[tuple[Arrival, bytes]]] = defaultdict(list)
    for path, history in _records(directory.state / FOLDER):
        student, assignment = path.stem, path.parent.name
        for one in (*history.now.values(), *history.before):
            own = (student, assignment, f"{one.notebook}{SUFFIX}")
            when = one.when.isoformat() if one.when else ""
            parts = tuple(one.file.split("/")) if one.file else own
            arrival = Arrival("", parts, content=one.content, levels=len(parts))
            if one.by_hand:
                by_hand = Arrival("submitted", own, content=one.content)
                edits.setdefault(by_hand.key, Edit(handed_in=when))
            elif one.content not in inbox and (data := _bytes(directory, path, own, one.content)):
                edits.setdefault(arrival.key, Edit("", student, assignment, one.notebook, when))
                by_form[one.lms].append((arrival, data))
    for form, files in by_form.items():
        with inbox.receiving() as receiving:
            for _, data in files:
                receiving.keep(data)
            receiving.delivery = Delivery(tuple(arrival for arrival, _ in files), form)
    number = sum(map(len, by_form.values()))
    return [f"{number} files that an older version had collected are in the table now"] if number else []


def _records(folder: Path) -> Iterator[tuple[Path, _Older]]:
    for path in sorted(folder.glob("*/*.json")):
        try:
            yield path, msgspec.json.decode(path.read_bytes(), type=_Older)
        except (OSError, msgspec.MsgspecError):
            continue


def _bytes(directory: ClassDirectory, record: Path, own: tuple[str, ...], content: str) -> bytes:
    """Return the bytes with this hash, from ``submitted`` or from the folder of replaced notebooks; else empty."""
    try:
        data = read_bytes(directory.path.joinpath("submitted", *own))
        if hashlib.sha256(data).hexdigest() == content:
            return data
    except UnreadableSubmission:
        pass
    try:
        return gzip.decompress((record.with_suffix(".kept") / f"{content[:16]}{SUFFIX}.gz").read_bytes())
    except (OSError, EOFError):
        return b""
