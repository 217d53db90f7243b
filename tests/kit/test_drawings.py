"""Each drawing tells a wrong limit, a wrong direction and a node that counts from a right one."""

from __future__ import annotations

import json
from itertools import pairwise, product
from random import Random
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.judge.evidence_files import parse_reference
from autograder.kit.oracle.drawings import LADDER, dealt, drawn_until, levels, mixed, scans, shuffled

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.evidence import Part

LIMIT = 0.8
WRONG = (0.5, 0.8, 0.9, 1.1, 1.25, 1.5)
"""Limits that students write for another one, as its multiples."""


def is_far(ahead: float) -> bool:
    return ahead > LIMIT


def far(look: Callable[[Sequence[float]], float], drawn: Random) -> list[bool]:
    """Return for each scan of a drawing whether a node that looks somewhere takes the way for free."""
    aheads = mixed(drawn, [*levels(LIMIT), *levels(LIMIT)[2:6]], is_far)
    return [is_far(look(scan.value["ranges"])) for scan in scans(drawn, LIMIT, aheads)]


def test_no_two_usual_limits_have_the_same_levels_below_them() -> None:
    below = [sum(level < factor for level in LADDER) for factor in (*WRONG, 1.0)]
    assert len(set(below)) == len(below)


def test_levels_end_where_the_world_ends() -> None:
    assert levels(4.0, below=6.0) == [1.2, 2.6, 3.4, 3.92, 4.08, 4.72, 5.48]


@pytest.mark.parametrize(
    "look", [min, max, *(lambda ranges, ray=ray: ranges[ray] for ray in (1, 9, 18, 27, -1))]
)
def test_each_drawing_tells_every_other_direction_from_straight_ahead(
    look: Callable[[Sequence[float]], float],
) -> None:
    for number in range(50):
        right = far(lambda ranges: ranges[0], Random(number))
        assert far(look, Random(number)) != right


def test_each_kind_follows_each_and_the_order_is_another_one_in_each_drawing() -> None:
    orders = {tuple(map(is_far, mixed(Random(n), levels(LIMIT), is_far))) for n in range(50)}
    assert all({*pairwise(order)} == {*product((True, False), repeat=2)} for order in orders)
    assert len(orders) > 10


def test_cases_are_dealt_to_hands_none_of_which_is_empty() -> None:
    hands = dealt(Random(1), range(8), 3)
    assert all(hands)
    assert sorted(case for hand in hands for case in hand) == list(range(8))
    assert sum(map(len, dealt(Random(1), range(2), 3))) == 2


def test_an_impossible_drawing_is_an_error() -> None:
    with pytest.raises(ValueError, match="none of"):
        drawn_until(lambda: shuffled(Random(0), (1, 2)), lambda order: len(order) > 2)


def _told(part: Part) -> str:
    """Return all outputs of a run in a drawing, and what the subject has made of its endpoints."""
    return json.dumps([[event.name, event.data] for event in part.of("noted")])


@pytest.mark.parametrize(
    "exercise_id", [one for one in exercises.all_ids() if exercises.reference_path(one).exists()]
)
def test_each_recorded_drawing_alone_tells_the_recorded_wrong_answers_apart(exercise_id: str) -> None:
    reference = parse_reference(json.loads(exercises.reference_path(exercise_id).read_text()))
    for drawing in reference.parts:
        runs = {"the solution": _told(drawing)}
        runs |= {
            variant.text: _told(part)
            for variant in reference.variants
            for part in variant.parts
            if part.name == drawing.name
        }
        assert len(set(runs.values())) == len(runs), drawing.name
