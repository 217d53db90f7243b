"""The class whose points are exported."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER

if TYPE_CHECKING:
    from conftest import FakeEngine, TinyClass


@pytest.fixture
def klass(tiny: TinyClass, fake_engine: FakeEngine) -> TinyClass:
    """Ben's work was graded; the others have handed in nothing."""
    (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    tiny.submit("ben", 7, 10)
    tiny.grade()
    return tiny
