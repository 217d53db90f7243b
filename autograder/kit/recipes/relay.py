"""Recipes for a node that publishes a value computed from its inputs. The author declares the right output.

A ``Relay`` listens on one topic. A ``Hub`` listens on several, and may also serve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from autograder.kit.model import Pace
from autograder.kit.recipes.own_scenario import (
    QUIET,
    SILENCE,
    Declared,
    fields,
    once_met,
    pick,
    picked,
    put,
    variant,
)
from autograder.kit.rules import got_through, same, value

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.evidence import Part
    from autograder.kit.recipes.own_scenario import Met

__all__ = ["NAN", "NUMBER", "SILENCE", "WHOLE", "Hub", "Relay", "Reply", "To"]

NAN = float("nan")
NUMBER, WHOLE = object(), object()
"""Placeholders in the inputs for random numbers: multiples of a quarter, or whole numbers. All drawn numbers differ."""
PATIENCE = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""Time limit in seconds of wall time until the last message must have arrived."""

PAUSE = 0.5
"""The maximum number of seconds of the subject's time that a hub has for the message that is due after an input."""

Due = Callable[..., Any]
"""A function that is given all inputs so far and returns the value to publish after the last one, or :data:`SILENCE`.
"""


class To(NamedTuple):
    """An input for one of several topics and services.

    Attributes:
        name: The name of the topic or service, such as ``"/left"``.
        value: The value of the field ``data``; a dictionary is a whole message or request.
    """

    name: str
    value: Any


@dataclass(frozen=True)
class Reply:
    """The fields of a service's reply that ``due`` requires. The other fields may have any value."""

    fields: Mapping[str, Any]

    def __str__(self) -> str:
        return ", ".join(f"{name}={field}" for name, field in self.fields.items())


class Relay(Declared):
    """An exercise about a node that publishes on one topic a value computed from all its inputs on another topic.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_8_1.filter"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        field: The path of the field that contains the value in inputs and outputs, such as ``"range"`` or
            ``"pose.position.x"``.
        due: Returns the value to publish after the last of the inputs so far, or :data:`SILENCE`.
        gives: The inputs, with :data:`NUMBER` or :data:`WHOLE` in place of each random number; or a function that draws
            all inputs. It must draw the same number of inputs in each run.
        copies: The path of a field that each output copies from its input, such as ``"header.stamp"``. A field not
            named ``stamp`` must be a text.
        tolerance: The absolute or relative tolerance for numbers.
        roles: The roles of the subject's endpoints, the most telling first.

    Example::

        def due(celsius: list[float], after: float = 32.0) -> float:
            return celsius[-1] * 9 / 5 + after

        task = Relay("lab_8_1.converter", "Lab 8.1 · The converter", "Publish in °F.", field="data", due=due)
        task.asks("listens", 2, "Subscribes to the right topic", "subscription", "Subscribe to `celsius`")
        task.answers("converts", 8, "Publishes each temperature in Fahrenheit", "nine fifths of it, and 32 more")
        task.wrong("offset_forgotten", {"after": 0.0}, "Your node publishes 0 for 0 °C.", "Add 32.")
        EXERCISE = task.exercise()
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        field: str,
        due: Due,
        gives: Sequence[Any] | Callable[[Random], Sequence[Any]] = (NUMBER,) * 12,
        copies: str = "",
        tolerance: float = 1e-6,
        roles: Sequence[str] = ("subscription", "publisher"),
    ) -> None:
        super().__init__(exercise_id, title, task, once_met(self._happens), *roles, given="sent")
        self._field, self._gives, self._due, self._copied = field, gives, due, copies
        self._tolerance = tolerance

    def answers(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add the criterion that exactly the right values come, in order. For the arguments see :meth:`asks`."""
        self._compares(name, points, title, lambda seen: self._made(seen, self._due), self._outputs, words)

    def copies(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add the criterion that each output contains the copied field of the input that it answers.

        Outputs are matched with inputs from the end, so that one additional or missing message counts as one error
        only.
        """
        self._compares(name, points, title, self._copies_due, self._copies_made, words)

    def wrong(self, key: str, due: Due | Mapping[str, Any], says: str, next_step: str) -> None:
        """Add the mistake that all outputs follow a variant of ``due``, for as many inputs as the subject answered.

        Args:
            key: A stable name for the mistake.
            due: The variant as a function, or other values for arguments of the right function, such as ``{"window":
                99}``.
            says: The text for the student that says what happened.
            next_step: The text for the student that says what to do.
        """
        wrong = variant(self._due, due)

        def found(seen: Part) -> bool:
            made = self._outputs(seen)
            right, other = self._made(seen, self._due), self._made(seen, wrong)
            if not made or self._equal(right, made):
                return False
            # A subject that ended early may have been right so far: then only its end is the mistake.
            so_far = self._equal(other[: len(made)], made) and not self._equal(right[: len(made)], made)
            return so_far or self._equal(other, made)

        self._knows(key, found, says, next_step)

    def not_copied(self, key: str = "not_copied") -> None:
        """Add the mistake that the field to copy is empty."""
        self._knows(
            key,
            lambda seen: any(map(_is_empty, picked(seen, "message", self._copied))),
            f"{self._copied} of your messages is empty: your code did not copy it.",
            f"Copy it from the message that came: out.{self._copied} = message.{self._copied}.",
        )

    def too_early(self, key: str = "too_early") -> None:
        """Add the mistake that the subject publishes before it has had enough inputs."""

        def found(seen: Part) -> bool:
            inputs = self._inputs(seen)
            silent = next(
                (n for n in range(1, len(inputs) + 1) if self._due(inputs[:n]) is not SILENCE),
                len(inputs) + 1,
            )
            kinds = [event.kind for event in seen.events if event.kind in ("sent", "message")]
            return "message" in kinds and kinds[: kinds.index("message")].count("sent") < silent

        self._knows(
            key,
            found,
            "Your node publishes before it has received enough messages.",
            "Store each message. Return from the callback without publishing until you have enough messages.",
        )

    def _happens(self, met: Met) -> bool:
        draws, random = self._gives, met.bench.random
        inputs = list(draws(random) if callable(draws) else _drawn(draws, random))
        for number, given in enumerate(inputs, 1):
            fields: dict[str, Any] = {}
            if self._copied:
                stamp = {"sec": 1000 + number, "nanosec": number}
                put(fields, self._copied, stamp if self._copied.endswith("stamp") else f"input_{number}")
            put(fields, self._field, given)
            met.speakers[0].send(**fields)
            met.bench.settle()
        wanted = len(_outputs_due(inputs, self._due))
        came = met.bench.wait_until(lambda _: met.heard >= wanted, PATIENCE[met.bench.pace])
        met.bench.settle()
        return came

    def _inputs(self, seen: Part) -> list[Any]:
        return picked(seen, "sent", self._field)

    def _outputs(self, seen: Part) -> list[Any]:
        return picked(seen, "message", self._field)

    def _made(self, seen: Part, due: Due) -> list[Any]:
        return _outputs_due(self._inputs(seen), due)

    def _equal(self, one: Sequence[Any], other: Sequence[Any]) -> bool:
        return same(list(one), list(other), self._tolerance)

    def _copies_due(self, seen: Part) -> list[Any]:
        inputs, copied = self._inputs(seen), picked(seen, "sent", self._copied)
        due = [copy for n, copy in enumerate(copied, 1) if self._due(inputs[:n]) is not SILENCE]
        return due[-len(self._outputs(seen)) :]

    def _copies_made(self, seen: Part) -> list[Any]:
        return picked(seen, "message", self._copied)[-len(self._copies_due(seen)) :]


class Hub(Relay):
    """A node that publishes a value computed from all inputs so far, on several topics. It may also have services.

    The arguments are those of :class:`Relay`, with these differences: each of ``gives`` is a :class:`To`, and ``due``
    gets inputs with a ``name`` and a ``value``. If the last input is a call of a service, ``due`` returns a
    :class:`Reply`. If the node has a service, ``"service"`` must be one of ``roles``.

    Example::

        def due(given: Sequence[To]) -> object:
            newest = dict(given)  # the last value of each topic
            return sum(newest.values()) if len(newest) == 2 else SILENCE

        puts = [To(name, WHOLE) for name in ("/left", "/left", "/right", "/left", "/right")]
        task = Hub("lab_8_1.scales", "Lab 8.1 · The scales", "Publish the sum.", field="data", due=due, gives=puts)
        task.answers("totals", 10, "Publishes each total", "publish the sum of the newest weights")
    """

    def answers(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add a criterion: exactly the right values come, in order. For the arguments see :meth:`asks`."""

        def due(seen: Part) -> list[Any]:
            return [one for one in self._made(seen, self._due) if not isinstance(one, Reply)]

        self._compares(name, points, title, due, lambda seen: picked(seen, "message", self._field), words)

    def replies(self, field: str, points: float, title: str, words: str = "") -> None:
        """Add a criterion, named after a field of the replies: it is right in each reply for which ``due`` sets it."""

        def due(seen: Part) -> list[Any]:
            return [reply.fields[field] for reply in self._replies(seen) if field in reply.fields]

        def came(seen: Part) -> list[Any]:
            pairs = zip(self._replies(seen), fields(seen, "answered"), strict=False)
            return [answer[field] for reply, answer in pairs if field in reply.fields]

        self._compares(field, points, title, due, came, words)

    def _happens(self, met: Met) -> bool:
        draws, random, interface = self._gives, met.bench.random, met.bench.reference.interface
        speakers = dict(zip(sorted(interface.get("subscription", {})), met.speakers, strict=True))
        callers = dict(zip(sorted(interface.get("service", {})), met.callers, strict=True))
        if callable(draws):
            inputs = list(draws(random))
        else:
            values = _drawn([given.value for given in draws], random)
            inputs = [To(given.name, drawn) for given, drawn in zip(draws, values, strict=True)]
        for number, (name, given) in enumerate(inputs, 1):
            whole = given if isinstance(given, Mapping) else {"data": given}
            if name in callers:
                callers[name].ask(whole)
                if not callers[name].await_answers(QUIET[met.bench.pace]):
                    return False
            elif name in speakers:
                speakers[name].send(**whole)
            else:
                raise ValueError(f"gives: {name!r} is not one of {', '.join([*speakers, *callers])}")
            met.bench.settle()
            # Inputs on several topics may overtake each other, so the subject gets time for each input. If an input
            # makes a message due, this time ends when the message comes.
            due = [one for one in _outputs_due(inputs[:number], self._due) if not isinstance(one, Reply)]
            speaks = name in speakers and self._due(inputs[:number]) is not SILENCE
            met.bench.run_time(PAUSE, until=partial(_heard, met, len(due)) if speaks else None)
        return met.heard > 0 or not met.topics

    def _replies(self, seen: Part) -> list[Reply]:
        return [one for one in self._made(seen, self._due) if isinstance(one, Reply)]

    def _got_through(self, seen: Part, expected: Part) -> bool:
        return got_through(seen, expected, self._given, "answered")

    def _inputs(self, seen: Part) -> list[Any]:
        return [To(event.name, value(event)) for event in seen.events if event.kind in ("sent", "asked")]

    def _outputs(self, seen: Part) -> list[Any]:
        return [
            Reply(event.data["fields"])
            if event.kind == "answered"
            else pick(event.data["fields"], self._field)
            for event in seen.events
            if event.kind in ("message", "answered")
        ]

    def _equal(self, one: Sequence[Any], other: Sequence[Any]) -> bool:
        return len(one) == len(other) and all(
            all(same(field, came.fields.get(name)) for name, field in due.fields.items())
            if isinstance(due, Reply) and isinstance(came, Reply)
            else type(due) is not Reply and same(due, came, self._tolerance)
            for due, came in zip(one, other, strict=True)
        )


def _outputs_due(inputs: Sequence[Any], due: Due) -> list[Any]:
    made = (due(inputs[:number]) for number in range(1, len(inputs) + 1))
    return [one for one in made if one is not SILENCE]


def _drawn(inputs: Sequence[Any], random: Random) -> Iterator[Any]:
    numbers = iter(random.sample(range(4, 1000), len(inputs)))
    for given in inputs:
        drawn = given in (NUMBER, WHOLE) and next(numbers)
        yield drawn / 4 if given is NUMBER else drawn if given is WHOLE else given


def _heard(met: Met, number: int) -> bool:
    return met.heard >= number


def _is_empty(copied: Any) -> bool:
    return not any(copied.values()) if isinstance(copied, Mapping) else not copied
