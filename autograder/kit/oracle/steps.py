"""The steps of a judge that compares a node with the solution, and the services that it serves meanwhile."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import reduce
from math import inf, isinf
from typing import TYPE_CHECKING, Any, NamedTuple

from autograder.kit.in_words import counted
from autograder.kit.outcomes import CANCELED, all_goals, end_of
from autograder.kit.rules import sent_times

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.kit.evidence import Event, Part
    from autograder.kit.oracle.goal_sender import GoalSender
    from autograder.kit.outcomes import SentGoal

WORKS_ON = 4
"""The number of feedback messages after the answer to a cancel request that show a subject which does not look at it.
One that looks before each piece of its work may send one, or two if it works in several threads.
"""


class To(NamedTuple):
    """An input for one of several topics and services.

    Attributes:
        name: The name of the topic or service, such as ``"/left"``.
        value: The value of the field ``data``; a dictionary is a whole message or request.
        stands: Seconds of wall time for which the subject's clock stands still after the input. A node that asks
            another clock for the time then shows it, however busy the machine is.
        answered: Seconds of the subject's time until the judge answers the call that the input leads to, infinity
            for never; None if it answers at once.
    """

    name: str
    value: Any
    stands: float = 0.0
    answered: float | None = None

    def __str__(self) -> str:
        """Return the input in words, for the card."""
        return self.name + (f", then {self.stands:g} s while the robot's time stood" if self.stands else "")


class Text(To):
    """An input for a topic of texts, or a service with one: JSON, or nearly. The card shows it.

    Args:
        name: The name of the topic.
        value: What the text says, as data. Python writes ``nan`` and ``inf`` as ``NaN`` and ``Infinity``. A text stays
            as it is, for an input that is not JSON, or for ``1e400``.
        how: The other attributes of :class:`To`.
    """

    __slots__ = ()

    def __new__(cls, name: str, value: Any, **how: Any) -> Text:
        """Return the step."""
        return super().__new__(cls, name, value if isinstance(value, str) else json.dumps(value), **how)

    def __str__(self) -> str:
        """Return the input in words, for the card."""
        return f"{super().__str__()}: {self.value}"


def answer_delays(steps: Sequence[Step]) -> tuple[dict[int, float], set[int]]:
    """Return when the judge answers the calls that inputs lead to: the delays of late answers, and those never sent.

    Both are by the number of the call, counted from 1, in the order of the inputs that say when they are answered.
    """
    asked = [step.answered for step in steps if isinstance(step, To) and step.answered is not None]
    delays = dict(enumerate(asked, 1))
    never = {number for number, delay in delays.items() if isinf(delay)}
    return {number: delay for number, delay in delays.items() if delay and number not in never}, never


@dataclass(frozen=True)
class Sets:
    """A step in which the judge sets a parameter of the subject; the subject takes the value or refuses it.

    Attributes:
        parameter: The name of the parameter.
        value: The new value: a number, a text or a truth value.
        node: The beginning of the node's full name, such as the namespace ``"/left/"``; by default the subject's
            first node.
    """

    parameter: str
    value: float | str | bool
    node: str = ""

    @property
    def name(self) -> str:
        """The parameter, with its node if the author named one."""
        return f"{self.node}.{self.parameter}" if self.node else self.parameter


@dataclass(frozen=True)
class Goal:
    """A step in which the judge sends a goal to an action of the subject, and waits for its end.

    Attributes:
        name: The name of the action, such as ``"/dock"``.
        fields: The fields of the goal.
        cancel_after: The number of feedback messages after which the judge requests to cancel the goal; None if it does
            not. Of such a goal, only these feedback messages are compared, and the truth values of its result: the rest
            depends on the moment of the request. A subject that works on long after it has accepted the request, and
            then cancels, has another status.
        beside: Another goal that is sent while this one is served; None for a goal alone.
        after: For the goal ``beside`` another one: the number of feedback messages of the first goal after which it is
            sent; 0 for the same moment. Meanwhile the subject's time passes, so that its timers fire.

    Example::

        gives=lambda random: [
            Goal("/dock", {"distance": random.randint(2, 4)}),
            Goal("/dock", {"distance": 9}, cancel_after=3),
            Goal("/dock", {"distance": 2}, beside=Goal("/dock", {"distance": 3})),
            Goal("/dock", {"distance": 9}, beside=Goal("/dock", {"distance": 3}, after=7)),
            Goal("/dock", {"distance": -1}),
        ]
    """

    name: str
    fields: Mapping[str, Any]
    cancel_after: int | None = None
    beside: Goal | None = None
    after: int = 0

    @property
    def goals(self) -> list[Goal]:
        """This goal, and those that are sent while it is served."""
        return [self, *(self.beside.goals if self.beside else [])]

    def __str__(self) -> str:
        """Return the goal in words, for the card."""
        fields = ", ".join(f"{name} {value}" for name, value in self.fields.items())
        canceled = (
            ""
            if self.cancel_after is None
            else f", canceled after {counted(self.cancel_after, 'feedback message')}"
        )
        later = f" after {counted(self.after, 'feedback message')}" if self.after else ""
        return f"{self.name} with {fields}{later}{canceled}{f', beside {self.beside}' if self.beside else ''}"

    def play(self, sender: GoalSender) -> bool:
        """Send the goal, and wait for its end. Return False if it does not end."""
        numbers: list[int] = []
        for goal in self.goals:
            if goal.after:
                sender.pass_time(numbers[0], goal.after)
            numbers.append(sender.send(**goal.fields))
        for number, goal in zip(numbers, self.goals, strict=True):
            if goal.cancel_after is not None:
                sender.cancel(number, after=goal.cancel_after)
        return sender.finish(*numbers)

    def outcomes(self, seen: Part, paths: Sequence[str]) -> list[list[Any]]:
        """Return what came of the goal, and of the one beside it, if the judge has sent no other one since then.

        Args:
            seen: The record of the subject.
            paths: Each is ``"status"``, or ``"feedback"`` or ``"result"`` with the path of a field, as in
                ``"result.arrived"``.
        """
        sent = all_goals(seen)[-len(self.goals) :]
        return [
            [goal._outcome(one, path) for path in paths] for goal, one in zip(self.goals, sent, strict=True)
        ]

    def _outcome(self, sent: SentGoal, path: str) -> Any:
        part, _, field_path = path.partition(".")
        if part == "status":
            is_late = sent.sent_after(sent.cancel_answered_at) > WORKS_ON
            works_on = sent.status == CANCELED and is_late
            return f"{end_of(sent)}, long after the request" if works_on else end_of(sent)
        if part == "feedback":
            return [pick(fields, field_path) for fields in sent.feedback[: self.cancel_after]]
        value = pick(sent.result, field_path) if sent.result else None
        return value if self.cancel_after is None or isinstance(value, bool) else None


Step = To | Sets | Goal | float
"""A step of the judge: an input, a new value of a parameter, a goal, or a time to let pass, in seconds."""


class Turn(NamedTuple):
    """A step that the subject was given, with its number, and the event and the moment at which it begins."""

    number: int
    step: Step
    first: int
    began: float

    def events(self, seen: Part, following: Turn | None, *, by_time: bool) -> list[Event]:
        """Return the events from here to the following step; ``by_time``, messages by the time when they were sent."""
        last, ended = (following.first, following.began) if following else (len(seen.events), inf)
        began = self.began if self.number else -inf
        return [
            event
            for place, event in enumerate(seen.events)
            if (
                began <= _sent_at(event) < ended
                if by_time and event.kind == "message"
                else self.first <= place < last
            )
        ]


def _sent_at(message: Event) -> float:
    """Return when a message was sent, in seconds of the run's real time."""
    return message.t - (float(message.data.get("arrived", message.t)) - sent_times([message])[0])


def pick(fields: Any, path: str) -> Any:
    """Return the value of a field, given by its path, such as ``"pose.position.x"``.

    A question mark at the end, as in ``"message?"``, asks only whether there is a value that is not empty, 0 or false.
    """
    if path.endswith("?"):
        value = pick(fields, path[:-1])
        return bool(value.strip() if isinstance(value, str) else value)
    return reduce(lambda part, key: part[key], path.split("."), fields)
