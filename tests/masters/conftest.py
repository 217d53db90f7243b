"""Small courses to build from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.masters.master_cells import MASTER_HEADER as HEADER_LINES
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from autograder.masters.source_notebooks import Points

HEADER = HEADER_LINES + "\n"


@pytest.fixture
def course(tmp_path: Path) -> Path:
    """A course with one small master in it."""
    folder = tmp_path / "solutions" / "01_first" / "lab_9_1"
    folder.mkdir(parents=True)
    (folder / "lab.md").write_text(HEADER + SMALL_MASTER)
    return tmp_path


@pytest.fixture
def write_master(tmp_path: Path) -> Callable[[str], Path]:
    """Write a master of the name lab_9_1 with this text below its header."""

    def write(text: str) -> Path:
        path = tmp_path / "solutions" / "01_first" / "lab_9_1" / "lab.md"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(HEADER + text)
        return path

    return write


@pytest.fixture
def ten_points() -> Points:
    """Points for exercises that do not exist, so that these tests need no real ones."""
    return lambda check: 10.0


SMALL_MASTER = cases(__file__, "SMALL_MASTER")
