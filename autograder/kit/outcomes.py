"""Outcomes that a program has to report. The task names a word for each, and a line with this word reports it.

An exercise declares its outcomes, such as ``REJECTED = Outcome("rejected")``, and its task names the same words. One
rule holds for all of them. An outcome is reported if, in its run, the program logs, prints, raises or returns a line
with the word, and if this line, apart from numbers, does not also appear in runs with other outcomes.

A program passes if it says all words in each run, in a line with a word that it draws. One run of each outcome cannot
tell such a line from ``canceled: True`` beside ``canceled: False``, which is a report.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.kit.mistakes.crashes import on_purpose, raised_lines
from autograder.kit.model import Advice
from autograder.kit.reading.goals_seen import STATUS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.kit.evidence import Part

_STATUS = re2.compile(r"(?i)status")
_STATUS_NUMBER = re2.compile(r"(^\D*|[:=]\s*|\bis )([0-6])\b")
"""Matches a status number after the word ``status``: the first number, or one after a colon, an equals sign or ``is``.
"""
_NUMBERS = re2.compile(r"[\pL\pN_.+-]*\pN[\pL\pN_.+-]*|[\[\](){},;\s]+")
"""Matches numbers, words that contain a digit (such as a goal's id), and the separators between numbers of a list."""


@dataclass(frozen=True)
class Outcome:
    """An outcome, and the word from the task that reports it.

    Attributes:
        word: The word, in upper or lower case. A goal's status number after the word ``status`` also counts.
        other: A second spelling of the word, or a second word that the task allows.
    """

    word: str
    other: str = ""

    def is_said_in(self, line: str) -> bool:
        """Return True if a line contains the word. Any whitespace in the line counts as one space."""
        named = " ".join(_with_status_names(line).lower().split())
        return self.word in named or bool(self.other and self.other in named)

    def lines(self, part: Part) -> list[str]:
        """Return the lines of a run that contain the word."""
        return list(filter(self.is_said_in, all_lines(part)))

    def reported(self, part: Part, others: Iterable[Part]) -> str:
        """Return the line that reports the outcome in the outcome's run; empty if there is none.

        Args:
            part: The run that ended with this outcome.
            others: Runs that ended with another outcome.
        """
        usual = shapes(others)
        return next((line for line in self.lines(part) if shape(line) not in usual), "")

    def missing(self, part: Part, others: Sequence[Part]) -> str:
        """Return in words, for the card, what was said instead of a report; empty if the outcome is reported."""
        if self.reported(part, others):
            return ""
        if told := self.lines(part):
            return f"“{told[-1]}”, which is also said when it is not so"
        return f"“{said}”" if (said := _most_telling(part, others)) else "nothing was said of it"

    def advice(self, part: Part, others: Sequence[Part], what: str, next_step: str) -> Advice:
        """Return the advice for an outcome that is not reported. It quotes the program's own line.

        Args:
            part: The run that ended with this outcome.
            others: Runs that ended with another outcome.
            what: What happened in the run, in a clause such as ``"The goal was rejected"``.
            next_step: What the student should do about it.
        """
        asked = f"the task asks for a line with {self}"
        if told := self.lines(part):
            says = f"your program said “{told[-1]}”. It says that also when it is not so"
        elif said := _most_telling(part, others):
            says = f"your program said “{said}”; {asked}"
        else:
            says = f"your program did not say so; {asked}"
        return Advice(f"{what}, and {says}.", next_step)

    def __str__(self) -> str:
        """Return the word as the card shows it."""
        return f"the word{'s' * (' ' in self.word)} `{self.word}`"


def all_lines(part: Part) -> list[str]:
    """Return everything that a program said in a run: logged, printed, returned, or raised on purpose."""
    raised = raised_lines(part.traceback) if on_purpose(part.traceback) else []
    return [line for line in (*part.said(), *raised) if line.strip()]


def shape(line: str) -> str:
    """Return a line without its numbers, so that lines about two different goals can be compared."""
    return " ".join(_NUMBERS.sub(" ", _with_status_names(line).lower()).split())


def shapes(parts: Iterable[Part]) -> set[str]:
    """Return the shapes of all lines of these runs, as a set."""
    return {shape(line) for part in parts for line in all_lines(part)}


def _with_status_names(line: str) -> str:
    word = _STATUS.search(line)
    if word is None:
        return line
    behind = _STATUS_NUMBER.sub(lambda found: found[1] + STATUS[int(found[2])], line[word.end() :])
    return f"{line[: word.end()]}{behind}"


def _most_telling(part: Part, others: Sequence[Part]) -> str:
    """Return the last line with words that other runs do not contain; failing that, the last line with any words."""
    lines = [line for line in all_lines(part) if re2.search(r"\pL", line) and line != "None"]
    usual = shapes(others)
    new = [line for line in lines if shape(line) not in usual]
    return (new or lines or [""])[-1]
