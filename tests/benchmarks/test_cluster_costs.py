"""What docs/performance.md says a class costs is what was measured."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec
import pytest

from benchmarks import cluster
from benchmarks.cluster import Costs, markdown, put_into, seconds
from benchmarks.machine import Machine

if TYPE_CHECKING:
    from pathlib import Path

COSTS = Costs(Machine(2, 8.0, "3.12", "Linux"), "2025-01-01", 1.0, 27, 1.7, 0.05, 0.001, 30_000, 60_000)


def test_the_page_quotes_what_is_kept() -> None:
    kept = msgspec.json.decode(cluster.KEPT.read_bytes(), type=Costs)
    assert markdown(kept) in cluster.PAGE.read_text(encoding="utf-8"), "run: python -m benchmarks.cluster"


def test_time_follows_from_cores_until_the_grader_or_the_scheduler_is_the_limit() -> None:
    assert seconds(COSTS, 100, 2) == pytest.approx(100)
    assert seconds(COSTS, 100, 4) == pytest.approx(50)
    assert seconds(COSTS, 100, 1_000) == pytest.approx(5)
    assert "beyond about 40 cores" in markdown(COSTS)
    assert "beyond about 4000 cores" in markdown(replace(COSTS, grader=0.0005, scheduler=0.0))
    assert seconds(replace(COSTS, scheduler=0.1), 100, 1_000) == pytest.approx(10)
    assert "beyond about 20 cores" in markdown(replace(COSTS, scheduler=0.1))


@pytest.mark.parametrize(
    ("spent", "words"), [(3, "3 s"), (119, "119 s"), (150, "2.5 min"), (7_200, "2.0 h"), (1e6, "12 d")]
)
def test_times_are_told_in_units_of_people(spent: float, words: str) -> None:
    assert cluster._told(spent) == words


def test_a_page_without_a_place_is_left_as_it_is(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("no place")
    with pytest.raises(ValueError, match="no place for the figures"):
        put_into(page, COSTS)
    page.write_text(f"before {cluster.BEGIN} old {cluster.END} after")
    put_into(page, COSTS)
    assert page.read_text() == f"before {cluster.BEGIN}\n\n{markdown(COSTS)}\n{cluster.END} after"
