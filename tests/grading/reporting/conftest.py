"""The class whose points are exported."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER
from tiny_class import FakeEngine, TinyClass

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def _of_ben(to_be_copied: TinyClass) -> Path:
    (to_be_copied.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    to_be_copied.submit("ben", 7, 10)
    with FakeEngine().at_work():
        to_be_copied.grade()
    return to_be_copied.path


@pytest.fixture
def klass(_of_ben: Path, fake_engine: FakeEngine, tmp_path: Path) -> TinyClass:
    """Ben's work was graded; the others have handed in nothing."""
    return TinyClass(shutil.copytree(_of_ben, tmp_path / "class"))
