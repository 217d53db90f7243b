"""The class whose points are exported."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass


@pytest.fixture
def klass(klass: TinyClass, fake_engine: FakeEngine) -> TinyClass:
    """Ben's work was graded; the others have handed in nothing."""
    klass.submit("ben", 7, 10)
    klass.grade()
    return klass
