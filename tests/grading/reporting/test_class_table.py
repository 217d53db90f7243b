"""The table of a large class costs as much as its rows, not as its rows times its students."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.grading.collecting.collected_files import CollectedRecords
from autograder.grading.reporting import class_statistics as figures
from autograder.grading.reporting import export_files
from autograder.grading.reporting.class_table import ClassTable
from autograder.grading.reporting.lms_gradebooks import gradebook
from autograder.grading.table.roster import Roster, Student
from autograder.grading.table.rows import Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ASSIGNMENTS = ("lab_1", "lab_2")
NO_RECORDS = CollectedRecords(Path("nowhere"))
CLASS = [f"s{number}" for number in range(60)]


class Counted(tuple[Row, ...]):
    """Rows that know how often somebody has gone through all of them."""

    read = 0

    def __iter__(self) -> Iterator[Row]:
        Counted.read += 1
        return super().__iter__()


def table() -> ClassTable:
    rows = [
        Row(student, assignment, f"{assignment}.a", 5, 10, "failed")
        for student in CLASS
        for assignment in ASSIGNMENTS
    ]
    return ClassTable(Counted(rows), Roster(map(Student, CLASS)), {})


@pytest.mark.parametrize(
    "use",
    [
        lambda table: gradebook("sakai", table, NO_RECORDS, ASSIGNMENTS, {}),
        lambda table: gradebook("moodle", table, NO_RECORDS, ASSIGNMENTS, {}),
        lambda table: export_files.class_csv(table, ASSIGNMENTS),
        lambda table: [table.max_score(one) for _ in CLASS for one in ("", *ASSIGNMENTS)],
        lambda table: [table.assignments and table.students for _ in CLASS],
        figures.bands,
        figures.totals,
    ],
    ids=["sakai", "moodle", "sheet", "max_score", "names", "bands", "totals"],
)
def test_all_rows_are_read_a_few_times_however_many_students_there_are(
    use: Callable[[ClassTable], object],
) -> None:
    Counted.read = 0
    use(table())
    assert Counted.read < 10


def test_the_points_that_can_be_had_are_those_of_who_can_have_most() -> None:
    rows = (
        Row("ada", "lab_1", "lab_1.a", 0, 0, "excused"),
        Row("ada", "lab_2", "lab_2.a", 5, 10, "failed"),
        Row("ben", "lab_1", "lab_1.a", 5, 10, "failed"),
        Row("ben", "lab_2", "lab_2.a", 5, 10, "failed"),
        Row("ben", "lab_2", "dropped", -5, -10, "dropped"),
    )
    both = ClassTable(rows, Roster([Student("ada"), Student("ben")]), {})
    assert [both.max_score(name) for name in ("lab_1", "lab_2", "", "lab_9")] == [10, 10, 10, 0]
    assert [both.only([one]).max_score("lab_1") for one in ("ada", "ben")] == [0, 10]
    assert ClassTable((), Roster([]), {}).max_score() == 0


def test_an_assignment_of_which_one_check_could_not_be_made_has_no_points_yet() -> None:
    rows = (
        Row("ada", "lab_1", "lab_1.a", 10, 10, "passed"),
        Row("ada", "lab_1", "lab_1.b", 0, 10, "not_checked"),
    )
    unchecked = ClassTable(rows, Roster([Student("ada")]), {})
    assert unchecked.score("ada", "lab_1") is None
    by_hand = replace(unchecked, rows=(rows[0], replace(rows[1], score=6.0, by_hand=6.0)))
    assert by_hand.score("ada", "lab_1") == 16


def test_who_is_excused_from_half_is_where_their_share_is() -> None:
    """Ada has all that she can have, Ben half of it."""
    rows = (
        Row("ada", "lab_1", "lab_1.a", 0, 0, "excused"),
        Row("ada", "lab_2", "lab_2.a", 10, 10, "passed"),
        Row("ben", "lab_1", "lab_1.a", 0, 10, "failed"),
        Row("ben", "lab_2", "lab_2.a", 10, 10, "passed"),
        Row("cleo", "lab_1", "lab_1.a", 0, 0, "by_hand"),
    )
    bands = figures.bands(ClassTable(rows, Roster(map(Student, ("ada", "ben", "cleo"))), {}))
    assert {band.low: band.students for band in bands if band.students} == {
        90: ("ada",),
        50: ("ben",),
        0: ("cleo",),
    }


def test_the_total_is_that_of_the_exported_assignments() -> None:
    rows = (Row("ada", "lab_1", "lab_1.a", 3, 4, "failed"), Row("ada", "lab_2", "lab_2.a", 5, 10, "failed"))
    table = ClassTable(rows, Roster([Student("ada")]), {})
    for names, total, most in ((["lab_1"], 3, 4), (["lab_2"], 5, 10), (list(ASSIGNMENTS), 8, 14)):
        header, ada = export_files.class_csv(table, names).decode("utf-8-sig").splitlines()
        cells = dict(zip(header.split(","), ada.split(","), strict=True))
        assert (cells["total"], cells["max"]) == (str(total), str(most))
