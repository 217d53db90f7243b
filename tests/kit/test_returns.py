"""A function without ROS is called once with a drawn list, and each value that it returns is compared."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.model import UNKNOWN
from autograder.kit.oracle.returns import Returns
from tests.kit.test_rules import HOSTILE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.model import Exercise


class Plain:
    """A bench without ROS, for a subject that is a function, or a program that prints what it returns."""

    def __init__(
        self, function: Callable[[Any], Any], recorded: Sequence[Part] = (), *, prints: bool = False
    ):
        self.pace, self.random = Pace.FAST, Random("seed")
        self.reference = Reference("a.b", {}, recorded)
        self.parts: list[Part] = []
        self._function, self._prints = function, prints

    def part(self, name: str) -> None:
        self.parts.append(Part(name, {}, []))

    def start(self, given: Any) -> None:
        returned = repr(self._function(given))
        if self._prints:
            self.parts[-1].events.append(Event(0.1, "output", "stdout", {"text": "[0, 0]"}))  # type: ignore[attr-defined]
        shown = (
            Event(0.1, "output", "stdout", {"text": returned})
            if self._prints
            else Event(0.1, "subject", "returned", {"value": returned})
        )
        self.parts[-1].events.append(shown)  # type: ignore[attr-defined]

    def await_end(self, _: float) -> bool:
        return True

    def again(self) -> None:
        self.parts[-1] = Part(self.parts[-1].name, {}, [])

    def seen(self) -> Part:
        return self.parts[-1]

    def note(self, name: str, **data: Any) -> None:
        self.parts[-1].events.append(Event(0.2, "noted", name, data))  # type: ignore[attr-defined]

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: None


def doubles(**more: Any) -> Exercise:
    """Return twice of each number."""
    return Returns(
        "a.b", "A", "B", gives=lambda random: [random.randrange(1, 90) for _ in range(5)], **more
    ).exercise()


def right(numbers: Sequence[int]) -> list[int]:
    return [2 * number for number in numbers]


def judged(function: Callable[[Any], Any], *, prints: bool = False, **more: Any) -> tuple[bool, str]:
    """Return whether a function passes, and the first mistake that is recognized."""
    exercise = doubles(**more)
    solution = Plain(right)
    exercise.scenario(solution)  # type: ignore[arg-type]
    bench = Plain(function, solution.parts, prints=prints)
    exercise.scenario(bench)  # type: ignore[arg-type]
    evidence = Evidence(bench.parts, bench.reference)
    (criterion,) = exercise.criteria
    keys = (one.key for one in exercise.mistakes if one.recognize(evidence) and one.key != UNKNOWN)
    return criterion.judge(evidence).passed, next(keys, "")


def test_the_solution_is_recorded_with_several_lists_and_a_subject_gets_one_of_them() -> None:
    solution = Plain(right)
    doubles().scenario(solution)  # type: ignore[arg-type]
    given = [[event.data["given"] for event in part.of("noted")] for part in solution.parts]
    assert len({tuple(one) for one in given}) == len(given) == 4
    assert [len(one) for one in given] == [5] * 4


@pytest.mark.parametrize(
    ("function", "passes", "key"),
    [
        (right, True, ""),
        (lambda numbers: tuple(right(numbers)), True, ""),
        (lambda numbers: [2.0 * number + 1e-5 for number in numbers], True, ""),
        (lambda numbers: [2 * number + 1 for number in numbers], False, ""),
        (lambda numbers: right(numbers)[:-1], False, ""),
        (lambda numbers: right(numbers)[::-1], False, ""),
        (lambda numbers: [None for _ in numbers], False, "not_written"),
        (lambda numbers: None, False, ""),
        (lambda numbers: 42, False, ""),
        (lambda numbers: [], False, ""),
    ],
)
def test_each_value_that_is_returned_counts(function: Callable[[Any], Any], passes: bool, key: str) -> None:
    assert judged(function) == (passes, key)


class Says(list[Any]):
    """A list that writes itself as a text that is not its own."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self._text = text

    def __repr__(self) -> str:
        return self._text


@pytest.mark.parametrize("text", [*HOSTILE, f"[{10**400}, 1, 2, 3, 4]", "[1e999, 1j, ..., b'', {1}]"])
@pytest.mark.parametrize("prints", [False, True])
def test_whatever_a_function_returns_is_compared(text: str, prints: bool) -> None:
    assert judged(lambda _: Says(text), prints=prints) == (False, "")


def test_a_program_prints_its_list_last() -> None:
    assert judged(right, prints=True) == (True, "")


def test_the_tolerance_is_the_authors() -> None:
    near = lambda numbers: [2 * number + 0.3 for number in numbers]  # noqa: E731
    assert judged(near, tolerance=0.5) == (True, "")
    assert judged(near) == (False, "")


def test_what_the_first_call_keeps_shows_in_the_second() -> None:
    kept: list[list[int]] = []

    def of_the_first_list(numbers: Sequence[int]) -> list[int]:
        kept.append(right(numbers))
        return kept[0]

    assert judged(of_the_first_list) == (False, "")
