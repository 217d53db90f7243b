"""A recipe for a node that listens on one topic and publishes on another; the author declares the right output."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from autograder.kit.model import Pace
from autograder.kit.recipes.declared import SILENCE, Declared, picked, put, variant
from autograder.kit.recipes.own_scenario import once_met
from autograder.kit.rules import same

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.evidence import Part
    from autograder.kit.recipes.own_scenario import Met

__all__ = ["NAN", "NUMBER", "SILENCE", "WHOLE", "Relay"]

NAN = float("nan")
NUMBER, WHOLE = object(), object()
"""Placeholders in the inputs for random numbers: multiples of a quarter, or whole numbers. All drawn numbers differ."""
PATIENCE = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""Time limit in seconds of wall time until the last message must have arrived."""

Due = Callable[..., Any]
"""A function that is given all inputs so far and returns the value to publish after the last one, or :data:`SILENCE`.
"""


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
    ) -> None:
        scenario = once_met(self._happens)
        super().__init__(exercise_id, title, task, scenario, "subscription", "publisher", given="sent")
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
            right, other = self._made(seen, self._due), self._made(seen, wrong)[: len(made)]
            return bool(made) and not self._equal(right, made) and self._equal(other, made)

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


def _outputs_due(inputs: Sequence[Any], due: Due) -> list[Any]:
    made = (due(inputs[:number]) for number in range(1, len(inputs) + 1))
    return [one for one in made if one is not SILENCE]


def _drawn(inputs: Sequence[Any], random: Random) -> Iterator[Any]:
    numbers = iter(random.sample(range(4, 1000), len(inputs)))
    for given in inputs:
        drawn = given in (NUMBER, WHOLE) and next(numbers)
        yield drawn / 4 if given is NUMBER else drawn if given is WHOLE else given


def _is_empty(copied: Any) -> bool:
    return not any(copied.values()) if isinstance(copied, Mapping) else not copied
