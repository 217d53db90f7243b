"""How the same thing ends when it is judged again and again, and what of that should not be."""

from __future__ import annotations

import sys
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.verdict import Verdict


@dataclass(frozen=True)
class Repeated:
    """What came of judging again and again.

    Attributes:
        judgements: How many verdicts there were in all.
        subjects: Of how many things.
        repeated: How many of these were judged more than once, without which nothing can change.
        minutes: Wall time.
        how: The circumstances, in words.
        changed: Those that did not come to the same end each time: how often they came to which.
        unexpected: Those whose end is not the one that the bank expects, and why.
    """

    judgements: int
    subjects: int
    repeated: int
    minutes: float
    how: str
    changed: dict[str, dict[str, int]] = field(default_factory=dict)
    unexpected: dict[str, str] = field(default_factory=dict)

    def text(self) -> str:
        """The result as plain text."""
        lines = [
            f"{self.judgements} judgements of {self.subjects} ({self.repeated} more than once) in "
            f"{self.minutes:.1f} minutes, {self.how}: {len(self.changed)} changed, {len(self.unexpected)} unexpected",
            *(f"changed: {name}: {in_words(ends)}" for name, ends in self.changed.items()),
            *(f"unexpected: {name}: {why}" for name, why in self.unexpected.items()),
        ]
        return "\n".join(lines)


class Ends:
    """Ends as they come, counted."""

    def __init__(self) -> None:
        self._ends: dict[str, Counter[str]] = defaultdict(Counter)
        self._unexpected: dict[str, str] = {}

    def add(self, name: str, end: str, objection: str = "") -> None:
        """Count an end, and say on standard error where it is another one than before."""
        if self._ends[name] and end not in self._ends[name]:
            print(f"{name}: {end}, not {next(iter(self._ends[name]))}", file=sys.stderr, flush=True)
        self._ends[name][end] += 1
        if objection:
            self._unexpected[name] = objection

    def result(self, minutes: float, how: str) -> Repeated:
        """All of them."""
        return Repeated(
            judgements=sum(ends.total() for ends in self._ends.values()),
            subjects=len(self._ends),
            repeated=sum(ends.total() > 1 for ends in self._ends.values()),
            minutes=minutes,
            how=how,
            changed={
                name: dict(ends.most_common()) for name, ends in sorted(self._ends.items()) if len(ends) > 1
            },
            unexpected=dict(sorted(self._unexpected.items())),
        )


def end_of(verdict: Verdict) -> str:
    """State, points and diagnosis in a few words: what must not change."""
    key = verdict.diagnosis.key if verdict.diagnosis else ""
    return in_one_line(verdict.state, verdict.score, verdict.max_score, key)


def in_one_line(state: str, score: float, max_score: float, key: str) -> str:
    """An end in a few words."""
    return f"{state}, {score:g} of {max_score:g}{', ' if key else ''}{key}"


def in_words(ends: Mapping[str, int]) -> str:
    """How often it came to which end."""
    return "; ".join(f"{number} times {end}" for end, number in ends.items())
