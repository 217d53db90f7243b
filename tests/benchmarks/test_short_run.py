"""The benchmark in its shortest form, from end to end: nothing about time is asked for but that it ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from benchmarks.__main__ import SHORT, measure
from benchmarks.results import markdown

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.ros
@pytest.mark.slow
def test_every_figure_is_measured(tmp_path: Path) -> None:
    found = measure(SHORT, tmp_path)
    named = {figure.name: figure for figure in found.figures}
    for word in ("against `nbgrader autograde`", "points for honest", "cores busy"):
        assert any(word in name for name in named)
    assert named["points for honest submissions, here and in stock nbgrader"].reached, found.differences
    # Gross: graded at the same time, two students cannot take longer than stock nbgrader needs for each alone.
    assert "0.0 times" not in markdown(found)
