"""A list of times is taken for the assignment that it is about, and the first time of the same bytes counts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from downloads import write_zip
from test_chosen_names import when
from test_collect import placed, why, work
from test_collected_csv import edit, read
from test_submitted_file_names import add_assignment

from autograder.cli import cli
from autograder.grading.collecting.collect import collect

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

LABS = ("lab_1_2", "lab_1_3")


@pytest.fixture
def both(klass: TinyClass, tmp_path: Path) -> TinyClass:
    """A class that has collected work of Ada's and Ben's for two assignments."""
    add_assignment(klass, "lab_1_3")
    for number, lab in enumerate(LABS):
        names = (f"lovelaceada_101_700{number}_{lab}.ipynb", f"barben_102_701{number}_{lab}.ipynb")
        collect(klass.path, [write_zip(tmp_path / f"{lab}.zip", dict.fromkeys(names, work(klass, number)))])
    return klass


def times(folder: Path, name: str = "times.csv", hour: int = 10) -> Path:
    path = folder / name
    path.write_text(
        f"user_id,submitted_at,login_id\n101,2026-11-20T{hour}:00:00Z,ada\n102,2026-11-20T{hour}:00:00Z,ben\n"
        f"105,2026-11-20T{hour}:00:00Z,zoe\n"
    )
    return path


def hours(klass: TinyClass) -> dict[str, int | None]:
    found = {lab: when(klass, "ada", lab) for lab in LABS}
    return {lab: time.hour if time else None for lab, time in found.items()}


def test_a_list_with_an_assignment_is_about_this_assignment_only(both: TinyClass, tmp_path: Path) -> None:
    arguments = ["collect", str(both.path), str(times(tmp_path)), "--assignment", "lab_1_2"]
    result = CliRunner().invoke(cli, arguments)
    assert "times.csv: the file was read as a list: 2 times taken, for lab_1_2" in result.output
    assert hours(both) == {"lab_1_2": 10, "lab_1_3": None}
    collect(both.path, [times(tmp_path, "later.csv", 15)], assignment="lab_1_3")
    assert hours(both) == {"lab_1_2": 10, "lab_1_3": 15}


def test_a_list_that_may_be_about_two_assignments_gives_no_time_and_says_so(
    both: TinyClass, tmp_path: Path
) -> None:
    report = collect(both.path, [times(tmp_path)])
    assert hours(both) == {"lab_1_2": None, "lab_1_3": None}
    (line,) = [one for one in report.outcomes if one.label == "times.csv"]
    assert line.reason == (
        "the file was read as a list: no time taken; 2 students have work for lab_1_2 and lab_1_3: "
        "collect the list again with --assignment"
    )
    collect(both.path, [times(tmp_path)], assignment="lab_1_3")
    assert hours(both) == {"lab_1_2": None, "lab_1_3": 10}


def test_a_list_of_the_only_assignment_so_far_is_still_about_it_later(
    klass: TinyClass, tmp_path: Path
) -> None:
    add_assignment(klass, "lab_1_3")
    name = "lovelaceada_101_7001_{}.ipynb"
    collect(klass.path, [write_zip(tmp_path / "2.zip", {name.format("lab_1_2"): work(klass, 1)})])
    report = collect(klass.path, [times(tmp_path)])
    assert [one.reason for one in report.outcomes if one.label == "times.csv"] == [
        "the file was read as a list: 1 time taken, for lab_1_2"
    ]
    collect(klass.path, [write_zip(tmp_path / "3.zip", {name.format("lab_1_3"): work(klass, 2)})])
    assert hours(klass) == {"lab_1_2": 10, "lab_1_3": None}


FIRST = "2026-11-20T10:00:00Z"
AGAIN = "2026-11-28T10:00:00Z"


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize("names", [("101_7001", "LATE_101_8001"), ("101_7001", "101_7001")])
def test_the_first_time_of_the_same_bytes_counts_and_a_line_says_so(
    klass: TinyClass, tmp_path: Path, names: tuple[str, str], order: tuple[int, int]
) -> None:
    for place in order:
        file = f"lovelaceada_{names[place]}_lab_1_2.ipynb"
        listed = tmp_path / f"{place}.csv"
        listed.write_text(f"user_id,submitted_at,login_id\n101,{(FIRST, AGAIN)[place]},ada\n")
        report = collect(klass.path, [write_zip(tmp_path / f"{place}.zip", {file: work(klass, 1)}), listed])
    assert str(when(klass, "ada")) == "2026-11-20 10:00:00+00:00"
    words = "the same bytes were handed in again on 2026-11-28 10:00 UTC: the first time counts"
    assert words in " ".join(one.reason for one in report.outcomes)
    result = CliRunner().invoke(cli, ["collect", str(klass.path), str(tmp_path / "1.zip")])
    assert words in result.output
    edit(klass, "lovelaceada", handed_in="2026-11-29 10:00")
    collect(klass.path)
    assert str(when(klass, "ada")) == "2026-11-29 10:00:00+00:00", "a person's cell"


def test_who_goes_back_to_an_earlier_file_is_graded_by_it_and_has_its_first_time(
    klass: TinyClass, tmp_path: Path
) -> None:
    days = {"1": 1, "2": 2, "3": 1}
    files = {
        f"Lab_ada_attempt_2025-10-0{day}-14-00-00_lab_1_2.ipynb": work(klass, points)
        for day, points in days.items()
    }
    report = collect(klass.path, [write_zip(tmp_path / "b.zip", files)])
    assert (why(report), len(placed(report))) == ("", 1)
    assert str(when(klass, "ada")) == "2025-10-01 14:00:00+00:00"
    assert sorted(line["counts"] for line in read(klass)[1]) == ["earlier", "the same", "yes"]
