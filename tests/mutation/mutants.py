"""Mutants: right answers with one edit each, under ids that unrelated edits of the answer leave alone."""

from __future__ import annotations

import difflib
import hashlib
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from autograder.authoring.mutants import engine
from autograder.authoring.mutants.code import Code
from autograder.authoring.mutants.equivalents import equivalent
from tests.mutation.given_code import given_lines
from tests.mutation.line_operators import LINES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.authoring.mutants.code import Edit
    from tests.mutation.subjects import Subject

LOGS_FREELY = ("lab_1_2.talker", "lab_1_3.server", "lab_1_4.server")
"""Exercises in which nobody has to log anything, so that no mutant is made of a log line."""
_HEADER = "=== "
"""Begins a section of a bank workspace (``autograder/authoring/answer_tables.py``)."""


@dataclass(frozen=True)
class Mutant:
    """A right answer with one edit.

    Attributes:
        id: Such as ``"lab_1_2.talker/while_loop_sleep.py:number:1c9d02aa"``. Its last part is made of what is changed,
            not of where in the file it stands.
        subject: The right answer.
        operator: The name of the operator.
        line: The line of the answer that is changed, from 1.
        text: The whole mutant.
    """

    id: str
    subject: Subject
    operator: str
    line: int
    text: str

    @property
    def name(self) -> str:
        """Its id."""
        return self.id

    @property
    def exercise(self) -> str:
        """The exercise's id."""
        return self.subject.exercise

    @property
    def digest(self) -> str:
        """Changes with the text."""
        return hashlib.sha256(self.text.encode()).hexdigest()[:16]

    def difference(self) -> str:
        """What is changed, as a unified diff without its head."""
        before, after = self.subject.text.splitlines(), self.text.splitlines()
        return "\n".join(list(difflib.unified_diff(before, after, lineterm="", n=1))[2:])

    def verdict(self, seed: str) -> bytes:
        """Judge it in this very process, a fork made for it; the verdict as JSON."""
        listed = self.subject.listed
        with TemporaryDirectory(prefix="mutant-") as folder:
            file = Path(folder, "mutants", listed.file.name if listed else "solution.py")
            file.parent.mkdir()
            return self.subject.verdict(self.text, file, seed)


def mutants(subject: Subject) -> list[Mutant]:
    """All first-order mutants of an answer, in the order of its text; no two of them mean the same.

    Those that a rule shows to be equivalent are left out, and those of what the notebook has before the task.
    """
    means = partial(_meaning, subject)
    code = Code(subject.text) if _is_python(subject) else None
    given = given_lines(subject.exercise, subject.text) if code else set()
    return [
        Mutant(f"{subject.name}:{one.key}", subject, one.operator, one.line, one.text)
        for one in engine.mutants(subject.text, list(_changes(subject)), means)
        if code is None or not (one.line in given or equivalent(code, one))
    ]


def _is_python(subject: Subject) -> bool:
    return subject.answer.endswith(".py")


def _changes(subject: Subject) -> Iterator[engine.Change]:
    for start, text, is_python in _pieces(subject):
        if is_python:
            code = Code(text, logs=subject.exercise not in LOGS_FREELY)
            found = engine.python_changes(code)
        else:
            found = [(operator.__name__, edit) for operator in LINES for edit in operator(text)]
        for operator, edit in found:
            yield operator, _moved(edit, start)


def _moved(edit: Edit, by: int) -> Edit:
    """The same edit of a text in which everything stands further behind."""
    also = tuple(_moved(piece, by) for piece in edit.also)
    return replace(edit, start=edit.start + by, end=edit.end + by, also=also)


def _pieces(subject: Subject) -> Iterator[tuple[int, str, bool]]:
    """The files in an answer: where each begins in its text, the file, and whether it is Python."""
    if subject.answer.endswith(".workspace"):
        head, *sections = f"\n{subject.text}".split(f"\n{_HEADER}")
        start = len(head)
        for section in sections:
            # A file that is removed is a header alone.
            name, newline, text = section.partition("\n")
            start += len(_HEADER) + len(name) + len(newline)
            if " " not in name:  # a whole file, not one that is changed, moved or removed
                yield start, text, name.endswith(".py")
            start += len(text) + 1
    else:
        yield 0, subject.text, _is_python(subject)


def _meaning(subject: Subject, text: str) -> str | None:
    """What a text means to Python, whatever it looks like; None where it means nothing."""
    return engine.meaning(text) if _is_python(subject) else text


def sampled(found: list[Mutant], size: int, seed: int) -> list[Mutant]:
    """A sample in which every exercise has its share, in the order of ``found``.

    What is in it depends on ids alone, so a new answer or a new operator leaves most of a sample as it was.

    Args:
        found: All mutants.
        size: How many are wanted; all of them where there are no more.
        seed: Decides which.
    """
    ahead: dict[str, list[Mutant]] = {}
    for mutant in sorted(found, key=lambda mutant: hashlib.sha256(f"{seed}:{mutant.id}".encode()).digest()):
        ahead.setdefault(mutant.exercise, []).append(mutant)
    turns = [mutant for turn in zip_longest(*ahead.values()) for mutant in turn if mutant is not None]
    wanted = {mutant.id for mutant in turns[:size]}
    return [mutant for mutant in found if mutant.id in wanted]
