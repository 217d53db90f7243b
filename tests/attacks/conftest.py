"""The whole bank, graded once: every attack is a student of one class, in one batch, beside two honest ones."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.append(str(Path(__file__).parent))  # not first: other folders have a conftest, too

from attack_bank import attacks
from attack_class import AttackClass, Traps

if TYPE_CHECKING:
    from collections.abc import Iterator

    from attack_class import Graded


@pytest.fixture(scope="session")
def traps(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Traps]:
    """What lies around the class."""
    with Traps(tmp_path_factory.mktemp("traps")) as laid:
        yield laid


@pytest.fixture(scope="session")
def graded(tmp_path_factory: pytest.TempPathFactory, traps: Traps) -> Graded:
    """The class after its batch."""
    made = AttackClass(tmp_path_factory.mktemp("attacked"), traps)
    for attack in attacks():
        made.hand_in(attack)
    return made.grade()
