"""The bank, graded once: each attack of the session is a student of one class, in one batch, beside honest ones."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.append(str(Path(__file__).parent))  # not first: other folders have a conftest, too

from attack_class import AttackClass, Traps

from tests.tiers import asked_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from attack_bank import Attack
    from attack_class import Graded


@pytest.fixture(scope="session")
def traps(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Traps]:
    """What lies around the class."""
    with Traps(tmp_path_factory.mktemp("traps")) as laid:
        yield laid


@pytest.fixture(scope="session")
def chosen(request: pytest.FixtureRequest) -> list[Attack]:
    """The attacks of this session: those that tests ask for."""
    return asked_for(request, "attack")


@pytest.fixture(scope="session")
def graded(tmp_path_factory: pytest.TempPathFactory, traps: Traps, chosen: list[Attack]) -> Graded:
    """The class after its batch."""
    made = AttackClass(tmp_path_factory.mktemp("attacked"), traps)
    for attack in chosen:
        made.hand_in(attack)
    return made.grade()
