"""The benchmark's own arithmetic, and that the page quotes the file."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from autograder.grading.classes.class_directory import ClassDirectory
from benchmarks import figures, results
from benchmarks.__main__ import PAGE, RESULTS
from benchmarks.classes import bank_variants, make_class
from benchmarks.machine import Usage, machine
from benchmarks.ours import OurRun, _while_working
from benchmarks.stock import StockRun

if TYPE_CHECKING:
    from pathlib import Path

USAGE = Usage(seconds=60.0, busy=0.9, own_cpu=90.0, load=1.0, others=0.05)


def ours(**other: object) -> OurRun:
    fields = {
        "notebooks": 180,
        "report": {},
        "usage": USAGE,
        "busy_working": 0.9,
        "points": {},
    }
    return OurRun(**{**fields, **other})  # type: ignore[arg-type]


def test_stock_is_extrapolated_student_by_student_and_its_start_is_paid_once_an_assignment() -> None:
    stock = StockRun(("a", "b"), 4, 2.0, {"x": 12.0, "y": 22.0}, {}, USAGE)
    assert stock.per_notebook == 7.5
    assert stock.for_class(100) == 2 + 5 * 100 + 2 + 10 * 100
    figure = figures.throughput([stock], ours(), 100)
    assert figure.measured.startswith("25.1 times: 60 s")
    assert figure.reached is False
    assert figures.throughput([stock], ours(), 200).reached is True


def test_a_figure_says_whether_its_aim_is_reached() -> None:
    assert figures.busy(ours(busy_working=0.84)).reached is False
    assert figures.busy(ours(busy_working=0.86)).reached is True
    assert figures.points(["one"], 9).measured == "8 of 9 notebooks identical"


def test_cores_count_from_the_first_notebook_to_the_last() -> None:
    report: dict[str, object] = {"timings": {"first_started": 2.3, "last_ended": 5.9}}
    assert _while_working([0.1, 0.1, 1.0, 1.0, 0.7, 0.0, 0.0], report) == pytest.approx(0.9)


def sources(notebook: Path) -> list[str]:
    return [cell["source"] for cell in json.loads(notebook.read_text())["cells"]]


def test_the_class_is_the_same_at_every_run_and_mostly_honest(tmp_path: Path) -> None:
    made = make_class(tmp_path / "class", 8, ("exercise_1_2", "lab_1_2"))
    again = make_class(tmp_path / "again", 8, ("exercise_1_2", "lab_1_2"))
    for student in made.students:
        for assignment in made.assignments:
            name = f"submitted/{student}/{assignment}/{assignment}.ipynb"
            assert sources(made.path / name) == sources(again.path / name)
    assert 0 < 16 - len(made.honest) <= 4
    assert len(ClassDirectory(made.path).submissions()[0]) == 16


def test_no_answer_of_the_class_runs_into_a_time_limit() -> None:
    for variants in bank_variants().values():
        assert variants.right
        assert not any("endless" in file for file in variants.wrong)


def test_figures_are_kept_and_quoted_as_they_are(tmp_path: Path) -> None:
    found = results.Results(
        machine(), "2026-01-01", "short", 1.0, (figures.busy(ours()),), ("A note.",), ("One.",)
    )
    results.write(found, tmp_path / "results.json")
    assert results.read(tmp_path / "results.json") == found
    page = tmp_path / "page.md"
    page.write_text(f"before\n\n{results.BEGIN}\nold\n{results.END}\n\nafter\n")
    results.put_into(page, found)
    text = page.read_text()
    assert "| cores busy from the first to the last notebook | at least 85% | 90% | yes |" in text
    assert text.startswith("before\n")
    assert text.endswith("\nafter\n")
    assert "old" not in text
    page.write_text("no place")
    with pytest.raises(ValueError, match="no place"):
        results.put_into(page, found)


def test_the_page_quotes_the_figures_that_are_kept() -> None:
    """Whoever changes a figure by hand, or forgets the page, meets this."""
    assert results.markdown(results.read(RESULTS)) in PAGE.read_text()
