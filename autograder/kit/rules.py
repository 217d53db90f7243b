"""Rules for a subject that reports a state from time to time, and functions that compare message contents.

The state depends on the inputs that the subject was given. For a subject that answers each input, see
``recipes/relay.py`` and ``recipes/machine.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isclose, isnan
from typing import TYPE_CHECKING, Any, NamedTuple

from autograder.kit.in_words import counted
from autograder.kit.model import Finding
from autograder.kit.rate import sent_times

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.kit.draft import Judge
    from autograder.kit.evidence import Event, Part


class _SomeText:
    """A value that :func:`same` treats as equal to every text that is not blank."""

    def __str__(self) -> str:
        return "a text"


SOME_TEXT = _SomeText()
"""Use this in an expected reply for a text that students may choose."""


def value(event: Event) -> Any:
    """Return the content of a message, request or answer: its field ``data``, or all fields if it has no such field."""
    return event.data["fields"].get("data", event.data["fields"])


def values(kind: str, name: str | None = None) -> Callable[[Part], list[Any]]:
    """Return a function that lists, for a part, the contents of its events of a kind, in order of time.

    If ``name`` is given, the function lists only events with this name.
    """
    return lambda seen: [value(event) for event in seen.of(kind, name)]


SENT = values("sent")
"""Returns the contents of the messages that the judge published."""


def got_through(seen: Part, expected: Part, *kinds: str) -> bool:
    """Return True if the subject was given as many inputs as the reference solution.

    If the result is False, the subject ended or hung before it had been given all inputs.

    Args:
        seen: The record of the subject.
        expected: The record of the reference solution.
        kinds: The kinds of events that record an input, such as ``"sent"`` and ``"asked"``.
    """
    return all(len(seen.of(kind)) >= len(expected.of(kind)) for kind in kinds)


class Given(NamedTuple):
    """An input of the subject.

    Its fields are its age in seconds of the subject's time, its :func:`value`, and the name of its topic or service.
    """

    age: float
    value: Any
    name: str


State = Callable[[Sequence[Given]], Any]
"""A function that is given all inputs of the subject up to a moment, in order. It returns what the subject must report
at that moment, or whether a condition holds.
"""


@dataclass(frozen=True)
class StateRule:
    """A rule for a subject that reports a state from time to time, which depends on its inputs and on time.

    Attributes:
        rule: Returns what the subject must report.
        slack: Tolerance in seconds. A report also counts as right if it was right at most this long before, or will be
            right at most this long after.
        given: The kind of event that records an input of the subject.
    """

    rule: State
    slack: float = 0.25
    given: str = "sent"

    def when(self, holds: State) -> Judge[Part]:
        """Return a criterion that the subject's reports are right at all times at which a condition holds.

        The subject must also report at least a quarter as often as the reference solution, so that silence is not
        right. The exact rate is not judged here, but by another criterion.
        """

        def judge(seen: Part, expected: Part) -> Finding:
            mine, theirs = (list(self._decided(part, holds)) for part in (seen, expected))
            many, wrong = counted(len(mine), "message"), [pair for pair in mine if not same(*pair)]
            if wrong:
                due, said = wrong[0]
                return Finding(False, in_words([due]), f"{in_words([said])} in {len(wrong)} of {many}")
            usual = in_words(list(dict.fromkeys(in_words([due]) for due, _ in mine or theirs)))
            enough = bool(mine) and 4 * len(mine) >= len(theirs)
            return Finding(enough, usual, usual if enough else f"{many} at such times")

        return judge

    def taken_for(self, *wrong: State) -> Callable[[Part, Part], bool]:
        """Return a function that recognizes a mistake: all reports are those of a wrong variant of :attr:`rule`."""

        def recognise(seen: Part, _: Part) -> bool:
            said = list(self._said(seen))
            right, *others = (
                all(any(same(what, rule(given)) for given in views) for what, views in said)
                for rule in (self.rule, *wrong)
            )
            return not right and any(others)

        return recognise

    def only_in_answer(self, seen: Part, _: Part) -> bool:
        """Return True if the subject makes at most one report for each input, and never reports without one."""
        given = [len(later) for _, (*_, later) in self._said(seen)]
        return bool(given) and all(number <= so_far for number, so_far in enumerate(given, 1))

    def _decided(self, part: Part, holds: State) -> Iterator[tuple[Any, Any]]:
        """Yield pairs of the required and the actual report, for each report at whose time only one content is right.

        A report is also left out unless the condition certainly holds at the report's time.
        """
        for what, views in self._said(part):
            due, *others = map(self.rule, views)
            if all(map(holds, views)) and all(same(due, other) for other in others):
                yield due, what

    def _said(self, part: Part) -> Iterator[tuple[Any, list[list[Given]]]]:
        """Yield each report with the inputs given until shortly before, at, and shortly after its time."""
        given: list[Event] = []
        for event in part.events:
            if event.kind == self.given:
                given.append(event)
            if event.kind == "message":
                now = reported_at(event)
                yield (
                    value(event),
                    [
                        [Given(age, value(g), g.name) for g in given if (age := at - g.moment) >= 0.0]
                        for at in (now - self.slack, now, now + self.slack)
                    ],
                )


def reported_at(event: Event) -> float:
    """Return the time at which a report was sent; in simulated time, the time at which it was recorded."""
    on_its_way = float(event.data.get("arrived", event.t)) - sent_times([event])[0]
    return event.moment - (on_its_way if event.sim is None else 0.0)


def same(one: Any, other: Any, tolerance: float = 1e-6) -> bool:
    """Return True if two contents, or lists of contents, are equal.

    Floating-point numbers may differ by ``tolerance`` (absolute, or relative to the larger one). NaN equals NaN, and
    :data:`SOME_TEXT` equals every text that is not blank.
    """
    if one is SOME_TEXT or other is SOME_TEXT:
        text = other if one is SOME_TEXT else one
        return isinstance(text, str) and bool(text.strip())
    if {type(one), type(other)} in ({float}, {float, int}):
        return (isnan(one) and isnan(other)) or isclose(one, other, rel_tol=tolerance, abs_tol=tolerance)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(same(one[key], other[key], tolerance) for key in one)
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(same(a, b, tolerance) for a, b in zip(one, other, strict=True))
    return bool(one == other)


def in_words(made: Sequence[object]) -> str:
    """Return a list of contents as one text for the card."""
    return ", ".join(f"{one:.10g}" if isinstance(one, float) else str(one) for one in made) or "nothing"
