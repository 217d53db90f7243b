"""Compares a run with those of the mutants of the solution, of which only what differs from the solution is kept.

A mutant is the solution with one likely mistake. Mutants that do the same in every practice drawing are one class.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from autograder.kit.oracle.outputs import Kind
from autograder.kit.rules import same

if TYPE_CHECKING:
    from autograder.kit.evidence import Part
    from autograder.kit.oracle.outputs import Output

TELLING = 2
"""The number of steps that have to differ before a mutant is named: one alone may be chance."""
Rows = Mapping[int, Sequence[Any]]
"""The values of an output, by the number of the step."""


@dataclass(frozen=True)
class Meaning:
    """What a mutant does differently, as data: no line of the solution is in it.

    Attributes:
        operator: The name of the operator that made the mutant.
        kind: Which of several things the operator did.
        place: The number of the solution's line in which it was done.
        spot: The number of the place in that line.
        quote: The sentence of the task that is about this place; empty if none is, or if several may be.
        name: What the notebook shows of the place: a method, an attribute or a word; empty if nothing.
        right: The number of the task that stands at the place; None if no number does, or the task does not show it.
        value: The number that stands there in the mutant.
    """

    operator: str
    kind: str
    place: int
    spot: int
    quote: str = ""
    name: str = ""
    right: float | None = None
    value: float | None = None


@dataclass(frozen=True)
class MutantClass:
    """Mutants that do the same.

    Attributes:
        meanings: What they do, by the numbers of their meanings.
        parts: The values that are not those of the solution, by drawing, output and step.
    """

    meanings: Sequence[int]
    parts: Mapping[str, Mapping[str, Rows]]


@dataclass(frozen=True)
class Mutants:
    """The mutants of a solution that its drawings tell from it.

    Attributes:
        reference: The SHA-256 of the record of the solution, with which they belong together.
        meanings: What the mutants do.
        classes: The classes of mutants, without those that crash.
        methods: The names of the methods that the solution defines, as far as the notebook shows them.
        solution: The record of the solution in the practice drawings.
    """

    reference: str
    meanings: Sequence[Meaning]
    classes: Sequence[MutantClass]
    methods: Sequence[str] = ()
    solution: Sequence[Any] = field(default=())  # of Part, which the file does not hold


@dataclass(frozen=True)
class Differences:
    """The difference of a run from the solution's: the values of each output by step, those of the solution beside.

    Attributes:
        drawing: The name of the drawing.
        seen: The values of the subject that differ, by output and step.
        is_whole: True if the run has all steps.
        is_returned: True if a function returned all of them, so that chance has no part in one.
    """

    drawing: str
    seen: Mapping[str, Rows]
    is_whole: bool
    is_returned: bool = False

    @property
    def tells(self) -> bool:
        """True if too much differs to be chance. The description of a parameter tells alone."""
        steps = [step for rows in self.seen.values() for step in rows]
        return len(steps) >= TELLING or 0 in steps or (self.is_returned and bool(steps))


def alike(one: Any, other: Any, tolerance: float) -> bool:
    """Return True if two steps have the same values; the order of messages in one instant is free."""
    if same(one, other, tolerance):
        return True
    if not (isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)) and len(one) == len(other)):
        return False
    rest = list(other)
    for value in one:
        place = next((n for n, left in enumerate(rest) if same(value, left, tolerance)), None)
        if place is None:
            return False
        del rest[place]
    return True


def rows(output: Output, part: Part) -> dict[int, Any]:
    """Return the values of an output by step. All messages of a list are one step."""
    return {event.data["step"]: event.data["values"] for event in part.of("noted", output.name)}


def steps_apart(mine: Rows, theirs: Rows, tolerance: float) -> list[int]:
    """Return the steps, in order, in which an output has other values than the solution's."""
    return [step for step in theirs if step in mine and not alike(mine[step], theirs[step], tolerance)]


def differences(outputs: Sequence[Output], seen: Part, due: Part) -> Differences:
    """Return the difference of a run of the subject from the solution's in the same drawing."""
    found: dict[str, Rows] = {}
    is_whole = True
    for output in outputs:
        if output.kind is Kind.RATE:
            continue
        mine, theirs = rows(output, seen), rows(output, due)
        is_whole = is_whole and mine.keys() == theirs.keys()
        if output.kind is Kind.LIST and output.compared(seen, due).passed:
            continue
        if steps := steps_apart(mine, theirs, output.tolerance):
            found[output.name] = {step: mine[step] for step in steps}
    is_returned = all(output.kind is Kind.RETURNED for output in outputs)
    return Differences(seen.name, found, is_whole, is_returned)


def meanings_of(mutants: Mutants, apart: Differences, tolerance: float) -> list[Meaning]:
    """Return what the mutants do whose runs are the subject's as a whole, or else in its first failed outputs.

    Of the outputs by themselves, the first one that is a mutant's counts.
    """
    drawn = [one for one in mutants.classes if apart.drawing in one.parts]
    wholes = [one for one in drawn if _are_alike(apart.seen, one.parts[apart.drawing], tolerance)]
    alone = (
        [
            one
            for one in drawn
            if _are_alike({name: values}, {name: one.parts[apart.drawing].get(name, {})}, tolerance)
        ]
        for name, values in apart.seen.items()
        if len(values) >= TELLING or 0 in values
    )
    matched = wholes or next(filter(None, alone), [])
    numbers = dict.fromkeys(number for one in matched for number in one.meanings)
    return [mutants.meanings[number] for number in numbers]


def _are_alike(one: Mapping[str, Rows], other: Mapping[str, Rows], tolerance: float) -> bool:
    return one.keys() == other.keys() and all(
        one[name].keys() == other[name].keys()
        and all(alike(one[name][step], other[name][step], tolerance) for step in one[name])
        for name in one
    )
