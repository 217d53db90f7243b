"""Reads and writes appeal files. Each contains one check of one student, as JSON for people and ``./course replay``."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import msgspec

from autograder.cards.readable_text import printable_json
from autograder.judge.evidence_files import Kept, plain, restored
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

FORMAT = "ros2-course-appeal-1"
ABOUT = (
    f"One check of one student. To judge it again: {COMMAND} replay FILE. This file proves nothing by itself: any "
    "person can write one. Only the class that it names has the grade and what the judge saw."
)
"""The text at the top of each appeal file."""
MAX_BYTES = 64_000_000
"""The maximum size of an appeal file in bytes. The largest possible evidence takes a fifth of this size."""
_WIDTH = 120
"""The maximum length of a line of JSON, in characters. A longer value takes several lines if possible."""


class BadAppeal(ValueError):
    """The file is not a complete appeal file. The message says what to do."""


class AppealedCell(msgspec.Struct, frozen=True):
    """The text of one cell that the student wrote.

    Attributes:
        cell: The name of the cell; empty for a cell that the student added.
        text: The text of the cell, as a list of lines.
    """

    cell: str
    text: list[str]


class Appeal(msgspec.Struct, frozen=True):
    """The content of an appeal file.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        notebook: The notebook's name.
        task: The task, in one sentence.
        course: The version of the course with which the check was made.
        solution: The student's cells that ran before the check, in order.
        expected: The reference output to which the check compared the subject; None if the course has a newer one.
        seen: The evidence, with the verdict that is in the gradebook.
    """

    student: str
    assignment: str
    notebook: str
    task: str
    course: str
    solution: list[AppealedCell]
    expected: Any
    seen: Kept


def dump(appeal: Appeal) -> bytes:
    """Return the content of an appeal file: JSON, with one line for each event."""
    content = plain(msgspec.to_builtins(appeal))
    head = {"format": FORMAT, "about": ABOUT}
    return ("\n".join(_lines({**head, **content}, "")) + "\n").encode()


def read(path: Path) -> Appeal:
    """Read an appeal file.

    Raises:
        BadAppeal: The file cannot be read, or is not an appeal file.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise BadAppeal(
            f"{path} cannot be read: {error.strerror}. Name a file that `appeal` wrote."
        ) from error
    if len(data) > MAX_BYTES:
        raise BadAppeal(f"{path} is larger than any appeal file: name a file that `appeal` wrote")
    try:
        content = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise BadAppeal(
            f"{path} is not an appeal file, or is only a part of one ({error}). Write it again: "
            f"{COMMAND} appeal CLASS STUDENT EXERCISE"
        ) from error
    if not isinstance(content, dict) or content.pop("format", None) != FORMAT:
        raise BadAppeal(
            f"{path} is JSON, but not an appeal file of this version of the course ({FORMAT}). "
            f"Write it again: {COMMAND} appeal CLASS STUDENT EXERCISE"
        )
    try:
        return msgspec.convert(restored(content), type=Appeal)
    except (ValueError, TypeError, RecursionError) as error:
        raise BadAppeal(f"{path} is not a valid appeal file: {error}") from error


def _lines(value: Any, indent: str, before: str = "", after: str = "") -> Iterator[str]:
    """Yield the lines of JSON for a value. A short value, or an event, takes a single line."""
    whole = _json(value)
    inside = (
        (list(value.items()) if isinstance(value, dict) else value) if isinstance(value, (dict, list)) else ()
    )
    is_event = isinstance(value, dict) and {"t", "kind", "name"} <= value.keys()
    if not inside or is_event or len(indent) + len(before) + len(whole) <= _WIDTH:
        yield f"{indent}{before}{whole}{after}"
        return
    yield f"{indent}{before}{'{' if isinstance(value, dict) else '['}"
    for place, item in enumerate(inside):
        comma = "," if place + 1 < len(inside) else ""
        if isinstance(value, dict):
            yield from _lines(item[1], f"{indent} ", f"{_json(item[0])}: ", comma)
        else:
            yield from _lines(item, f"{indent} ", "", comma)
    yield f"{indent}{'}' if isinstance(value, dict) else ']'}{after}"


def _json(value: Any) -> str:
    return printable_json(json.dumps(value, ensure_ascii=False))
