"""Outcomes that a program has to report: the task names a word for each, and a line with this word reports it.

An exercise declares its outcomes, such as ``REJECTED = Outcome("rejected")``, and names the same words in its task. One
rule holds for all of them: an outcome is reported if, in its run, a line that is logged, printed, raised or returned
has the word, and if that line, numbers aside, is not also said in runs that ended otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.kit.crashes import on_purpose, raised_lines
from autograder.kit.goals_seen import STATUS
from autograder.kit.model import Advice

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.kit.evidence import Part

_STATUS = re2.compile(r"(?i)status")
_STATUS_NUMBER = re2.compile(r"(^\D*|[:=]\s*|\bis )([0-6])\b")
"""A number behind the word ``status``: the first one, or one behind a colon or an equals sign, or behind ``is``."""
_NUMBERS = re2.compile(r"[\pL\pN_.+-]*\pN[\pL\pN_.+-]*|[\[\](){},;\s]+")
"""Numbers, words with a digit in them (such as a goal's id), and separators between the numbers of a list."""


@dataclass(frozen=True)
class Outcome:
    """An outcome, and the word in the task that reports it.

    Attributes:
        word: The word; upper or lower case does not matter. A goal's status number after the word ``status`` also
            counts.
        other: A second spelling, or a second word in the task.
    """

    word: str
    other: str = ""

    def is_said_in(self, line: str) -> bool:
        """Return whether a line has the word; any kind of space, and any number of them, is a space."""
        named = " ".join(_with_status_names(line).lower().split())
        return self.word in named or bool(self.other and self.other in named)

    def lines(self, part: Part) -> list[str]:
        """Return the lines of a run that have the word."""
        return list(filter(self.is_said_in, all_lines(part)))

    def reported(self, part: Part, others: Iterable[Part]) -> str:
        """Return the line that reports the outcome in its run; empty if there is none.

        Args:
            part: The run that ended with this outcome.
            others: Runs with another outcome.
        """
        usual = shapes(others)
        return next((line for line in self.lines(part) if shape(line) not in usual), "")

    def missing(self, part: Part, others: Sequence[Part]) -> str:
        """Return what was said instead of a report, in words for the card; empty if the outcome is reported."""
        if self.reported(part, others):
            return ""
        if told := self.lines(part):
            return f"“{told[-1]}”, which is also said when it is not so"
        return f"“{said}”" if (said := _most_telling(part, others)) else "nothing was said of it"

    def advice(self, part: Part, others: Sequence[Part], what: str, next_step: str) -> Advice:
        """Return the diagnosis of an outcome that is not reported; it quotes what was said.

        Args:
            part: The run that ended with this outcome.
            others: Runs with another outcome.
            what: What happened in the run, in a clause such as ``"The goal was rejected"``.
            next_step: What to do about it.
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
        """The word as the card shows it."""
        return f"the word{'s' * (' ' in self.word)} `{self.word}`"


def all_lines(part: Part) -> list[str]:
    """Return all that a program said in a run: logged, printed, returned, and raised on purpose."""
    raised = raised_lines(part.traceback) if on_purpose(part.traceback) else []
    return [line for line in (*part.said(), *raised) if line.strip()]


def shape(line: str) -> str:
    """Return a line without its numbers, so that two lines about two goals can be compared."""
    return " ".join(_NUMBERS.sub(" ", _with_status_names(line).lower()).split())


def shapes(parts: Iterable[Part]) -> set[str]:
    """Return the shapes of all lines of some runs."""
    return {shape(line) for part in parts for line in all_lines(part)}


def _with_status_names(line: str) -> str:
    word = _STATUS.search(line)
    if word is None:
        return line
    behind = _STATUS_NUMBER.sub(lambda found: found[1] + STATUS[int(found[2])], line[word.end() :])
    return f"{line[: word.end()]}{behind}"


def _most_telling(part: Part, others: Sequence[Part]) -> str:
    """Return the last line with words that other runs do not have, else the last line with words."""
    lines = [line for line in all_lines(part) if re2.search(r"\pL", line) and line != "None"]
    usual = shapes(others)
    new = [line for line in lines if shape(line) not in usual]
    return (new or lines or [""])[-1]
