"""The printed table shows every student, every result and every total, however many exercises a class has."""

from __future__ import annotations

import io
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from rich.console import Console
from tiny_class import shown

from autograder.grading.classes.student_folders import RefusedFile
from autograder.grading.reporting.grade_report import GradeReport, tables
from autograder.grading.table.rows import Row, columns

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass

STUDENTS = ("ada", "a-student-with-quite-a-long-id", "zoe")
EXERCISES = {
    "lab_1_2": ("lab_1_2.talker", "lab_1_2.listener", "why"),
    "own": ("test_1", "test_2"),
    "two": ("test_1",),
}
ROWS = [
    Row(student, assignment, exercise, 0.5 + place, 10, "failed", "wrong_text", name="Zoë Zuse")
    for student in STUDENTS
    for assignment, exercises in EXERCISES.items()
    for place, exercise in enumerate(exercises)
]


def printed(width: int) -> str:
    out = io.StringIO()
    console = Console(file=out, width=width)
    console.print(*tables(ROWS, console))
    return out.getvalue()


def test_cells_of_one_name_in_two_assignments_are_two_columns() -> None:
    assert list(columns(ROWS).values()) == [*EXERCISES["lab_1_2"], "own.test_1", "test_2", "two.test_1"]


@pytest.mark.parametrize(("width", "parts"), [(50, 6), (60, 3), (80, 2), (200, 1)])
def test_what_is_too_wide_is_several_tables(width: int, parts: int) -> None:
    text = printed(width)
    assert "…" not in text
    assert text.count("zoe") == text.count("student") - text.count("a-student") == parts
    assert text.count("total") == 1
    assert text.count("7/60") == len(STUDENTS)
    for score in ("0.5/10", "1.5/10", "2.5/10"):
        assert text.count(score) == len(STUDENTS) * {"0.5/10": 3, "1.5/10": 2, "2.5/10": 1}[score]


def test_a_file_that_is_not_taken_writes_no_line_of_its_own(tiny: TinyClass) -> None:
    refused = RefusedFile(Path("eve.zip"), "nobody is called x\x1b[2J\u202e\nada: 10 of 10")
    said = shown(GradeReport(tiny.path, (), refused=(refused,)))
    (line,) = (line for line in said.splitlines() if "eve.zip" in line)
    assert "ada: 10 of 10" in line
    assert "\x1b[2J" not in line
    assert "\u202e" not in line


def test_the_gradebook_is_the_one_of_the_configuration(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    assert tiny.grade().gradebook == tiny.path / "gradebook.db"
    other = tiny.path / "other.db"
    shutil.copy(tiny.path / "gradebook.db", other)
    tiny.configure(f"c.CourseDirectory.db_url = 'sqlite:///{other}'")
    assert f"gradebook  {other}" in shown(tiny.grade())
