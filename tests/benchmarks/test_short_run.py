"""The benchmark in its shortest form, from end to end: nothing about time is asked for but that it ends."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from benchmarks import overload
from benchmarks.__main__ import SHORT, measure
from benchmarks.results import markdown

if TYPE_CHECKING:
    from pathlib import Path

SHORTEST = replace(SHORT, regraded=2, turns=1)


@pytest.mark.ros
@pytest.mark.slow
def test_every_figure_is_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Busy loops and boxes without number would only slow down the tests that run beside this one.
    monkeypatch.setattr(overload, "BUSY_LOOPS", 1)
    monkeypatch.setattr(overload, "TIMES_CORES", 1)
    found = measure(SHORTEST, tmp_path)
    names = " ".join(figure.name for figure in found.figures)
    for word in (
        "against `nbgrader autograde`",
        "points for honest",
        "cores busy",
        "check cell",
        "box adds",
    ):
        assert word in names
    for word in ("regrading an unchanged class of 2", "verdicts", "`autograder execute` of 2 notebooks"):
        assert word in names
    same = {figure.name: figure for figure in found.figures}
    assert same["points for honest submissions, here and in stock nbgrader"].reached, found.differences
    # Gross: graded at the same time, two students cannot take longer than stock nbgrader needs for each alone.
    assert "0.0 times" not in markdown(found)
