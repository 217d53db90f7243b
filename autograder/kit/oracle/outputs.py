"""The outputs of a subject that are compared with the solution's: on a topic, of a service, or about a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

from autograder.kit.in_words import counted
from autograder.kit.model import Finding
from autograder.kit.oracle.parameter_answers import parameter_in_words
from autograder.kit.oracle.steps import pick
from autograder.kit.rules import has_rate, in_words, rate_of, same

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Part
    from autograder.kit.rules import Rate

NUMBER = "number of the message"
"""The path of the number of a message, counted from 1: it shows what was published before the judge listened."""
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
        both = min(len(mine), len(theirs))
        differs = self._parting(mine, theirs)
        if self.kind is Kind.LIST:
            # The messages before the judge stepped the clock do not count: how many came depends on the machine.
            stepped = [
                sum(event.data["stepped"] for event in part.of("noted", self.name))
                for part in (seen, expected)
            ]
            came_in_all, due_in_all = stepped if all(stepped) else (len(mine), len(theirs))
            missing = abs(came_in_all - due_in_all)
            around = slice(max(0, differs - 2), differs + 2)
            due, came = (
                f"{self._in_words([row for row, _ in rows[around]])} ({counted(len(rows), 'message')} in all)"
                for rows in (theirs, mine)
            )
            return Finding(differs == both and missing <= 1 + len(theirs) // ONE_MISSING_IN, due, came)
        if theirs and differs == len(theirs):
            return Finding(True, right := f"the same as the solution in all {len(theirs)} steps", right)
        due, came = (
            f"{self._in_words(rows[differs][0], others[differs][0] if differs < both else ())} {rows[differs][1]}"
            if differs < len(rows)
            else "nothing more"
            for rows, others in ((theirs, mine), (mine, theirs))
        )
        return Finding(False, due, came if differs < len(mine) else "nothing came from then on")

    def parts_at(self, seen: Part, expected: Part) -> Event | None:
        """Return what was noted in the first step in which the subject's outputs are others; None if there is none."""
        if self.kind is not Kind.STEPS:
            return None
        noted = seen.of("noted", self.name)
        return next(iter(noted[self._parting(self._rows(seen), self._rows(expected)) :]), None)

    def is_undeclared(self, seen: Part, _: Part) -> bool:
        """Return True if the subject has no parameter of this name."""
        return any(event.data["values"] == [[0, []]] for event in seen.of("noted", self.name))

    def another_rate(self, seen: Part, expected: Part) -> str:
        """Return the subject's rate in words if it is wrong; empty if it is right, or there are too few messages."""
        finding = self.compared(seen, expected)
        return "" if finding.passed or self._rate(seen) is None else finding.seen

    def _rate(self, seen: Part) -> Rate | None:
        given = [event.sim for event in seen.of("sent") + seen.of("asked") if event.sim is not None]
        return rate_of(seen.of("message", self.name), self.period, inputs=given)

    def _parting(self, mine: Sequence[Any], theirs: Sequence[Any]) -> int:
        """Return the index of the first row that differs; the number of compared rows if none does."""
        pairs = enumerate(zip(mine, theirs, strict=False))
        apart = (number for number, (one, other) in pairs if not same(one[0], other[0], self.tolerance))
        return next(apart, min(len(mine), len(theirs)))

    def _rows(self, part: Part) -> list[tuple[Any, str]]:
        """Return what is compared, in order: the values of each step with its words, or each message of a list."""
        noted = part.of("noted", self.name)
        if self.kind is Kind.LIST:
            return [(values, "") for event in noted for values in event.data["values"]]
        return [(event.data["values"], _when(event)) for event in noted]

    def _in_words(self, listed: Sequence[Sequence[Any]], others: Sequence[Sequence[Any]] = ()) -> str:
        if self.kind is Kind.PARAMETER:
            return "; ".join(map(parameter_in_words, listed)) or "nothing"
        named = ["" if self.paths == ("data",) else f"{path} = " for path in self.paths]
        told = [
            ", ".join(n + in_words([_shown(*pair)]) for n, *pair in zip(named, values, other, strict=True))
            for values, other in zip(listed, [*others, *listed[len(others) :]], strict=False)
        ]
        return "; ".join(told) or "nothing"


def _when(noted: Event) -> str:
    step, given = noted.data["step"], noted.data["given"]
    return f"after step {step} ({given})" if step else "at the start"


LONG = 8
"""The maximum length of a list that a card shows whole."""


def _shown(value: Any, other: Any) -> Any:
    """Return a value for the card: a number with four decimals, and of a long list the first item that differs."""
    if all(isinstance(one, (list, tuple)) and len(one) > LONG for one in (value, other)):
        pairs = enumerate(zip(value, other, strict=False))
        number = next((number for number, (one, two) in pairs if one != two), None)
        return value if number is None else f"{_shown(value[number], None)} at index {number}"
    if isinstance(value, (list, tuple)):
        return [_shown(one, None) for one in value]
    return round(value, 4) if isinstance(value, float) else value
