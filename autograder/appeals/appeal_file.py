"""Reads and writes appeal files. Each is a zip with one check of one student, for people and for ``./course replay``.

``replay`` reads two of the files in the zip: ``check.json`` and ``evidence.jsonl``, which contains a line of JSON for
each event. The others, such as the student's feedback page, are for people.
"""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

import msgspec

from autograder.command_name import COMMAND
from autograder.judge import evidence_files

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from autograder.judge.evidence_files import Kept

WARNING = (
    f"One check of one student. To judge it again: {COMMAND} replay FILE. This file proves nothing by itself: any "
    "person can write one. Only the class that it names has the grade and what the judge saw."
)
"""The text at the top of ``check.json``."""
CHECK, EVIDENCE = "check.json", "evidence.jsonl"
MAX_BYTES = 16_000_000
"""The maximum size of an appeal file, in bytes."""
_MAX_CHECK = 4_000_000
"""The maximum size of ``check.json``, in bytes. A submitted notebook has at most as much text as this."""


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


class AppealedCheck(msgspec.Struct, frozen=True):
    """The content of ``check.json``.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        notebook: The notebook's name.
        task: The task, in one sentence.
        course: The version of the course with which the check was made.
        solution: The student's cells that ran before the check, in order.
    """

    student: str
    assignment: str
    notebook: str
    task: str
    course: str
    solution: list[AppealedCell]


@dataclass(frozen=True)
class Appeal:
    """What ``replay`` needs of an appeal file: the check, and the evidence with the verdict in the gradebook."""

    check: AppealedCheck
    seen: Kept


def dump(check: AppealedCheck, evidence: bytes, others: Mapping[str, bytes]) -> bytes:
    """Return an appeal file.

    Args:
        check: The content of ``check.json``.
        evidence: The packed evidence.
        others: More files for people, by name.
    """
    about = {"about": WARNING, **msgspec.to_builtins(check)}
    files = {
        CHECK: json.dumps(about, indent=1).encode(),
        EVIDENCE: evidence_files.lines_of(evidence),
        **others,
    }
    whole = io.BytesIO()
    with ZipFile(whole, "w", ZIP_DEFLATED) as file:
        for name, data in files.items():
            file.writestr(name, data)
    return whole.getvalue()


def read(path: Path) -> Appeal:
    """Read an appeal file.

    Raises:
        BadAppeal: The file cannot be read, or is not an appeal file.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise ValueError("it is larger than any appeal file")
        with ZipFile(io.BytesIO(data)) as file:
            check = msgspec.convert(json.loads(_member(file, CHECK, _MAX_CHECK)), type=AppealedCheck)
            return Appeal(
                check, evidence_files.parse(_member(file, EVIDENCE, evidence_files.MAX_LINES_BYTES))
            )
    except OSError as error:
        raise BadAppeal(
            f"{path} cannot be read: {error.strerror}. Name a file that `appeal` wrote."
        ) from error
    except (ValueError, TypeError, LookupError, BadZipFile, RuntimeError, ArithmeticError) as error:
        raise BadAppeal(
            f"{path} is not an appeal file, or is only a part of one ({error}). Write it again: "
            f"{COMMAND} appeal CLASS STUDENT EXERCISE"
        ) from error


def _member(file: ZipFile, name: str, limit: int) -> bytes:
    if file.getinfo(name).compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise ValueError(f"{name} is compressed in another way")  # LZMA allocates what the file asks for
    with file.open(name) as member:
        data = member.read(limit + 1)
    if len(data) > limit:
        raise ValueError(f"{name} is too large for a file of an appeal")
    return data
