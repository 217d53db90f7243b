"""Outcomes that a program must report, such as a rejected goal, in a line with a word that the task names.

An exercise declares its outcomes, such as ``REJECTED = Outcome("rejected")``, and its task names the same words. An
outcome counts as reported if, in the run with this outcome, the program logs, prints, raises or returns a line with the
word. But a line that, apart from numbers, also appears in runs with other outcomes does not count.

This rule has a known gap: a program also passes if, in each run, it prints a line with all words and a random word. The
judge cannot tell this from ``canceled: True`` in one run and ``canceled: False`` in the others, which is a right
report.
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
"""Matches a status number in the text after the word ``status``: the first number in it, or one after a colon, an
equals sign or ``is``.
"""
_NUMBERS = re2.compile(r"[\pL\pN_.+-]*\pN[\pL\pN_.+-]*|[\[\](){},;\s]+")
"""Matches text that :func:`shape` removes: numbers, words that contain a digit (such as a goal's id), and separators in
a list of numbers.
"""


@dataclass(frozen=True)
class Outcome:
    """An outcome, and the word with which the task asks the program to report it.

    Attributes:
        word: The word, in lower case; a line may contain it in any case. If the word is the name of a goal's status,
            its number after the word ``status`` also counts.
        other: A second spelling of the word, or a second word that the task allows.
    """

    word: str
    other: str = ""

    def is_said_in(self, line: str) -> bool:
        """Return True if a line contains the word, or the status number that stands for it.

        Line breaks and other whitespace in the line count as spaces.
        """
        named = " ".join(_with_status_names(line).lower().split())
        return self.word in named or bool(self.other and self.other in named)

    def lines(self, part: Part) -> list[str]:
        """Return the lines of a run that contain the word."""
        return list(filter(self.is_said_in, all_lines(part)))

    def reported(self, part: Part, others: Iterable[Part]) -> str:
        """Return the line in the given run that reports the outcome; empty if there is none.

        Args:
            part: The run that ended with this outcome.
            others: Runs that ended with another outcome.
        """
        usual = shapes(others)
        return next((line for line in self.lines(part) if shape(line) not in usual), "")

    def missing(self, part: Part, others: Sequence[Part]) -> str:
        """Return in words for the card what the program reported instead; empty if it reported the outcome."""
        if self.reported(part, others):
            return ""
        if told := self.lines(part):
            return f"“{told[-1]}”, which your program also says in runs with another outcome"
        return f"“{said}”" if (said := _most_telling(part, others)) else "it was not reported"

    def advice(self, part: Part, others: Sequence[Part], what: str, next_step: str) -> Advice:
        """Return the advice for a program that does not report the outcome. It quotes one of the program's lines.

        Args:
            part: The run that ended with this outcome.
            others: Runs that ended with another outcome.
            what: What happened in the run, in a clause such as ``"The goal was rejected"``.
            next_step: What the student should do about it.
        """
        asked = f"the task asks for a line with {self}"
        if told := self.lines(part):
            says = f"your program said “{told[-1]}”. But it says the same in runs with another outcome"
        elif said := _most_telling(part, others):
            says = f"your program said “{said}”; {asked}"
        else:
            says = f"your program did not report this; {asked}"
        return Advice(f"{what}, and {says}.", next_step)

    def __str__(self) -> str:
        """Return the word as the card shows it, such as "the word `rejected`"."""
        return f"the word{'s' * (' ' in self.word)} `{self.word}`"


def all_lines(part: Part) -> list[str]:
    """Return all lines of a program in a run: logged, printed, returned, or raised on purpose."""
    raised = raised_lines(part.traceback) if on_purpose(part.traceback) else []
    return [line for line in (*part.said(), *raised) if line.strip()]


def shape(line: str) -> str:
    """Return a line without its numbers, in lower case, so that lines about two different goals can be compared."""
    return " ".join(_NUMBERS.sub(" ", _with_status_names(line).lower()).split())


def shapes(parts: Iterable[Part]) -> set[str]:
    """Return the :func:`shape` of each line in the given runs."""
    return {shape(line) for part in parts for line in all_lines(part)}


def _with_status_names(line: str) -> str:
    word = _STATUS.search(line)
    if word is None:
        return line
    behind = _STATUS_NUMBER.sub(lambda found: found[1] + STATUS[int(found[2])], line[word.end() :])
    return f"{line[: word.end()]}{behind}"


def _most_telling(part: Part, others: Sequence[Part]) -> str:
    """Return the last line whose words occur in no other run; if there is none, the last line with words."""
    lines = [line for line in all_lines(part) if re2.search(r"\pL", line) and line != "None"]
    usual = shapes(others)
    new = [line for line in lines if shape(line) not in usual]
    return (new or lines or [""])[-1]
