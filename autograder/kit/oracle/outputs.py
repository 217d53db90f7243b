"""The outputs of a subject that are compared with the solution's: on a topic, of a service, or about a parameter."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from itertools import groupby
from typing import TYPE_CHECKING, Any

from autograder.kit.in_words import counted
from autograder.kit.model import Finding
from autograder.kit.oracle.naming.step_words import quoted, when
from autograder.kit.oracle.parameter_answers import parameter_in_words
from autograder.kit.oracle.steps import pick
from autograder.kit.rules import has_rate, in_words, rate_of, same

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Part
    from autograder.kit.rules import Rate

NUMBER = "number of the message"
"""The path of the number of a message, counted from 1: it shows what was published before the judge listened."""
NO_OUTPUT = "nothing"
"""The word for no message at all."""
ONE_MISSING_IN = 4
"""One more or one fewer of this many messages may come, because each node asks and tells at its own moments."""


class Kind(Enum):
    """What is compared of an output."""

    STEPS = "the outputs of each step"
    RETURNED = "the items of the list that a function returned, each as a step"
    LIST = "all messages in order, however they are spread over the steps"
    PARAMETER = "the description of a parameter, and how new values of it are received"
    RATE = "the time between two messages"


@dataclass(frozen=True)
class Output:
    """An output of the subject, and how it is compared.

    Attributes:
        name: The topic, the service or the parameter.
        paths: The paths of the fields that are compared.
        kind: What is compared.
        tolerance: The tolerance for numbers, absolute or relative to the larger one.
        period: For a rate, the seconds between two messages.
    """

    name: str
    paths: tuple[str, ...]
    kind: Kind
    tolerance: float
    period: float = 0.0

    @property
    def key(self) -> str:
        """The name of the criterion."""
        return self.name.strip("/") + "_rate" * (self.kind is Kind.RATE)

    @property
    def title(self) -> str:
        """The line of the criterion on the card."""
        if self.kind is Kind.PARAMETER:
            return f"Describes the parameter {self.name}, takes the right values and refuses the others"
        if self.kind is Kind.RATE:
            return f"Keeps the rate on {self.name}"
        if self.kind is Kind.RETURNED:
            return "Returns the right values"
        told = [path for path in self.paths if path != NUMBER]
        # Every message of std_msgs has only a field named data, so this name alone says nothing on a card.
        what = "value" if told == ["data"] else " and ".join(told)
        return f"Says the right {what} on {self.name}"

    def deed(self, came: str) -> str:
        """Return in words that the subject said, or returned, what came."""
        if self.kind is Kind.RETURNED:
            return f"returns {came}"
        return f"says nothing on {self.name}" if came == NO_OUTPUT else f"says on {self.name}: {came}"

    def values(self, events: Sequence[Event]) -> list[list[Any]]:
        """Return the fields that are compared, for each message or answer among the events."""
        told = [e.data for e in events if e.kind in ("message", "answered") and e.name == self.name]
        return [
            [data.get("number") if path == NUMBER else pick(data["fields"], path) for path in self.paths]
            for data in told
        ]

    def compared(self, seen: Part, expected: Part) -> Finding:
        """Decide whether a subject's outputs are those of another run in the same drawing. Show the first that is not.

        Args:
            seen: The run of the subject.
            expected: The run of the solution, or of a recorded wrong answer.
        """
        if self.kind is Kind.RATE:
            return has_rate(seen.of("message", self.name), self.period, self._rate(seen))
        mine, theirs = self._rows(seen), self._rows(expected)
        differs = self._parting(seen, expected)
        if self.kind is Kind.LIST:
            around = slice(max(0, differs - 2), differs + 2)
            due, came = (
                f"{self._in_words([row for row, _ in rows[around]])} ({counted(len(rows), 'message')} in all)"
                for rows in (theirs, mine)
            )
            return Finding(self.agrees(seen, expected), due, came)
        if self.agrees(seen, expected):
            return Finding(True, right := f"the same as the solution in all {len(theirs)} steps", right)
        if differs >= min(len(mine), len(theirs)):
            due = (
                f"{self._in_words(theirs[differs][0])} {theirs[differs][1]}"
                if differs < len(theirs)
                else "nothing more"
            )
            came = (
                f"{self._in_words(mine[differs][0])} {mine[differs][1]}"
                if differs < len(mine)
                else "nothing came from then on"
            )
            return Finding(False, due, came)
        (one, when), (other, _) = mine[differs], theirs[differs]
        came, due = self._in_words(one, other), self._in_words(other, one)
        if came == due:  # they differ in what the words leave out
            came, due = str(one), str(other)
        # In the subject's run are the inputs, which the recording of the solution does not keep.
        return Finding(False, f"{due} {when}", f"{came} {when}")

    def agrees(self, seen: Part, expected: Part) -> bool:
        """Return True if a subject's outputs are those of another run in the same drawing."""
        if self.kind is Kind.RATE:
            return self.compared(seen, expected).passed
        mine, theirs, differs = self._values(seen), self._values(expected), self._parting(seen, expected)
        if self.kind is not Kind.LIST:
            return bool(theirs) and differs == len(theirs)
        # The messages before the judge stepped the clock do not count: how many came depends on the machine.
        stepped = [
            sum(event.data["stepped"] for event in part.of("noted", self.name)) for part in (seen, expected)
        ]
        came, due = stepped if all(stepped) else (len(mine), len(theirs))
        is_whole = abs(came - due) <= 1 + len(theirs) // ONE_MISSING_IN
        return is_whole and differs == min(len(mine), len(theirs))

    def parting_words(self, seen: Part, expected: Part) -> tuple[str, str, str] | None:
        """Return when the outputs first differ, and the fields that do: the subject's, and those of the solution.

        None if a row of one of both is missing, or if the outputs have no steps.
        """
        mine, theirs = self._rows(seen), self._rows(expected)
        differs = self._parting(seen, expected)
        if self.kind not in (Kind.STEPS, Kind.RETURNED) or differs >= min(len(mine), len(theirs)):
            return None
        (one, when), (other, _) = mine[differs], theirs[differs]
        both = min(len(one), len(other))
        right = next((n for n in range(both) if not same(one[n], other[n], self.tolerance)), both)
        if right and both > 1:
            when = f"{when}, then {counted(right, 'message')} as asked"
            one, other = one[right:], other[right : right + max(1, len(one) - right)]
        fields = [
            n
            for n in range(len(self.paths))
            if len(one) != len(other)
            or not all(same(a[n], b[n], self.tolerance) for a, b in zip(one, other, strict=True))
        ]
        paths = tuple(self.paths[n] for n in fields)
        alone = replace(self, paths=paths)
        of, due = ([[values[n] for n in fields] for values in listed] for listed in (one, other))
        came, asked = alone._in_words(of, due), alone._in_words(due, of)
        return (when, came, asked) if came != asked else (when, str(one), str(other))

    def parts_at(self, seen: Part, expected: Part) -> Event | None:
        """Return what was noted in the first step in which the subject's outputs are others; None if there is none."""
        return self.noted_at(seen, expected) if self.kind is Kind.STEPS else None

    def noted_at(self, seen: Part, expected: Part) -> Event | None:
        """Return the same, also for the description of a parameter, which is noted as step 0."""
        if self.kind not in (Kind.STEPS, Kind.PARAMETER):
            return None
        noted = seen.of("noted", self.name)
        return next(iter(noted[self._parting(seen, expected) :]), None)

    def is_undeclared(self, seen: Part, _: Part) -> bool:
        """Return True if the subject has no parameter of this name."""
        return any(event.data["values"] == [[0, []]] for event in seen.of("noted", self.name))

    def other_description(self, seen: Part, expected: Part) -> tuple[str, str] | None:
        """Return how the subject's parameter is declared, and how the solution's, in words; None if alike."""
        mine, theirs = (part.first("noted", self.name) for part in (seen, expected))
        if mine is None or theirs is None or same(mine.data["values"], theirs.data["values"], self.tolerance):
            return None
        return self._in_words(mine.data["values"]), self._in_words(theirs.data["values"])

    def only_news(self, seen: Part, expected: Part) -> bool:
        """Return True if messages come after inputs alone, although a rate is asked for."""
        came = [event.moment for event in seen.of("message", self.name)]
        given = [event.moment for event in seen.of("sent")]
        if self.compared(seen, expected).passed or not 1 < len(came) <= len(given) + 1:
            return False
        last = [max((at for at in given if at <= moment), default=None) for moment in came]
        # One message may come by itself, at the start or when something has become old.
        return len(set(last)) >= len(came) - 1

    def another_rate(self, seen: Part, expected: Part) -> str:
        """Return the subject's rate in words if it is wrong; empty if it is right, or there are too few messages."""
        finding = self.compared(seen, expected)
        return "" if finding.passed or self._rate(seen) is None else finding.seen

    def _rate(self, seen: Part) -> Rate | None:
        given = [event.sim for event in seen.of("sent") + seen.of("asked") if event.sim is not None]
        return rate_of(seen.of("message", self.name), self.period, inputs=given)

    def _parting(self, seen: Part, expected: Part) -> int:
        """Return the index of the first value that differs; the number of compared values if none does."""
        mine, theirs = self._values(seen), self._values(expected)
        pairs = enumerate(zip(mine, theirs, strict=False))
        apart = (number for number, (one, other) in pairs if not same(one, other, self.tolerance))
        return next(apart, min(len(mine), len(theirs)))

    def _values(self, part: Part) -> list[Any]:
        """Return what is compared, in order: the values of each step, or each message of a list."""
        noted = [event.data["values"] for event in part.of("noted", self.name)]
        return [value for values in noted for value in values] if self.kind is Kind.LIST else noted

    def _rows(self, part: Part) -> list[tuple[Any, str]]:
        """Return what is compared, each with the words for its step."""
        return [*zip(self._values(part), self._words(part), strict=True)]

    def _words(self, part: Part) -> list[str]:
        noted = part.of("noted", self.name)
        if self.kind is Kind.LIST:
            return [""] * len(self._values(part))
        if self.kind is Kind.RETURNED:
            return [f"for item {event.data['step']}, {event.data['given']}" for event in noted]
        # The messages are numbered if the judge listens only after the first input.
        unheard = int(NUMBER in self.paths)
        return [when(event, noted[:number], part, unheard) for number, event in enumerate(noted)]

    def _in_words(self, listed: Sequence[Sequence[Any]], others: Sequence[Sequence[Any]] = ()) -> str:
        if self.kind is Kind.PARAMETER:
            return "; ".join(map(parameter_in_words, listed)) or "nothing"
        told = [
            ", ".join(map(self._field_in_words, self.paths, values, other))
            for values, other in zip(listed, [*others, *listed[len(others) :]], strict=False)
        ]
        same_again = [(text, len([*group])) for text, group in groupby(told)]
        return "; ".join(text if n == 1 else f"{text}, {n} times" for text, n in same_again) or NO_OUTPUT

    def _field_in_words(self, path: str, value: Any, other: Any) -> str:
        if path.endswith("?"):
            return f"{path[:-1]} {'given' if value else 'empty'}"
        shown = quoted(_shown(value, other)) if self.paths == ("data",) else in_words([_shown(value, other)])
        return shown if self.paths == ("data",) else f"{path} = {shown}"


LONG, APART = 8, 2
"""The maximum length of a list that a card shows whole, and how many items it shows of two longer ones that differ."""


def _shown(value: Any, other: Any) -> Any:
    """Return a value for the card: a number with four decimals, and of a long list the first items that differ."""
    if all(isinstance(one, (list, tuple)) and len(one) > LONG for one in (value, other)):
        pairs = enumerate(zip(value, other, strict=False))
        apart = [number for number, (one, two) in pairs if one != two]
        told = ", ".join(f"{_shown(value[number], None)} at index {number}" for number in apart[:APART])
        return f"{told}{', …' * (len(apart) > APART)}" if apart else value
    if isinstance(value, (list, tuple)):
        return [_shown(one, None) for one in value]
    return round(value, 4) if isinstance(value, float) else value
