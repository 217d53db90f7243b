"""Every attack of the bank is defeated, and nobody else notices it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.append(str(Path(__file__).parent))  # not first: other folders have a conftest, too

from attack_bank import Attack, attacks
from attack_class import HONEST
from attack_demands import general_objections, objections

if TYPE_CHECKING:
    from attack_class import Graded, Traps

pytestmark = [pytest.mark.ros, pytest.mark.slow]
BANK = list(attacks())


@pytest.mark.parametrize("attack", BANK, ids=lambda attack: f"{attack.family}-{attack.name}")
def test_it_is_defeated(attack: Attack, graded: Graded, traps: Traps) -> None:
    found = objections(attack, graded, traps)
    assert not found, f"{attack.tries} Now {'; '.join(found)}"


@pytest.mark.parametrize("student", HONEST)
def test_an_honest_student_has_what_was_earned(student: str, graded: Graded) -> None:
    assert graded.points(student) == HONEST[student], graded.rows.get(student)


def test_the_batch_came_to_its_end_and_left_nothing_behind(
    graded: Graded, traps: Traps, chosen: list[Attack]
) -> None:
    assert not general_objections(chosen, graded, traps), graded.output[-2000:]
