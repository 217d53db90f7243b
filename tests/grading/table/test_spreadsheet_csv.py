"""No cell of a table is a formula, whoever wrote it."""

from __future__ import annotations

import csv
import io
import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from nbgrader.api import Gradebook

from autograder.grading.reporting.export_files import export
from autograder.grading.table.rows import Row, write_csv
from autograder.grading.table.spreadsheet_csv import csv_rows, csv_text, defused, original
from autograder.grading.table.students_csv import read_students_csv
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import FakeEngine, TinyClass


@pytest.mark.parametrize(("text", "written"), cases(__file__, "a_formula_becomes_text_and_text_stays"))
def test_a_formula_becomes_text_and_text_stays(text: str, written: str) -> None:
    assert defused(text) == written
    assert defused(written) == written, "once is enough"


def test_numbers_stay_numbers() -> None:
    assert csv_text([("-1", -1.5, 10.0)]) == "'-1,-1.5,10\n"


def test_every_column_of_the_grades_is_defused(tmp_path: Path) -> None:
    row = Row("=s", "+a", "-e", 1.0, 2.0, "@st", "=d\ne", '=HYPERLINK("x"),\r\n=2', -1.0, name="=n")
    write_csv(tmp_path / "grades.csv", [row])
    _, *rows = csv.reader(io.StringIO((tmp_path / "grades.csv").read_text()))
    assert rows == [
        ["'=s", "'+a", "'-e", "1", "2", "'@st", "'=d e", "'=HYPERLINK(\"x\"),'  =2", "-1", "", "", "", "'=n"]
    ]


def test_plain_nbgrader_export_is_defused_too(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("-ada", 4)
    tiny.grade()
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        book.update_or_create_student("-ada", last_name='=cmd,"\n+1', first_name="Ada", email="@x")
        book.update_or_create_student("ben")
    subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "nbgrader", "export"],
        cwd=tiny.path,
        env=os.environ | {"HOME": str(tiny.path)},
        check=True,
        capture_output=True,
    )
    rows = list(csv.DictReader(io.StringIO((tiny.path / "nbgrader_export.csv").read_text("utf-8-sig"))))
    wanted = ("student_id", "last_name", "email", "score", "max_score")
    assert {tuple(row[name] for name in wanted) for row in rows} == {
        ("'-ada", "'=cmd,'\" +1", "'@x", "14", "20"),
        ("ben", "", "", "", "20"),
    }


@pytest.mark.parametrize("student", ["+1+1", "-2+3", "@SUM", "-5"])
def test_an_id_that_looks_like_a_formula_goes_out_defused_and_comes_back_as_it_is(
    tiny: TinyClass, fake_engine: FakeEngine, student: str
) -> None:
    tiny.submit(student, 4, 2)
    tiny.grade()
    tables = {path: path.read_text("utf-8-sig") for path in [tiny.path / "grades.csv", *exported(tiny)]}
    for path, text in tables.items():
        cells = [cell for row in csv.reader(io.StringIO(text)) for cell in row]
        assert f"'{student}" in cells, path
        assert student not in cells, path
        assert any(student in map(original, row) for row in csv_rows(text.encode())[0]), path
    # A table that this program wrote is a list of students again.
    (tiny.path / "students.csv").write_text(f"id,first_name\n{defused(student)},Ada\n")
    assert [one.id for one in read_students_csv(tiny.path / "students.csv").students] == [student]


def exported(tiny: TinyClass) -> list[Path]:
    """What each export that is CSV writes."""
    files = [file for to in ("csv", "canvas", "moodle") for file, _ in export(tiny.path, to).files]
    return [file for file in files if file.suffix == ".csv"]


@pytest.mark.parametrize(
    ("text", "encoding", "separator"),
    cases(__file__, "a_table_is_read_as_excel_in_germany_or_an_old_mac_saves_it"),
)
def test_a_table_is_read_as_excel_in_germany_or_an_old_mac_saves_it(
    tiny: TinyClass, text: str, encoding: str, separator: str
) -> None:
    data = text.encode(encoding)
    assert csv_rows(data) == ([["id", "first_name"], ["bär", "Jörg"]], separator)
    (tiny.path / "students.csv").write_bytes(data)
    assert [(one.id, one.name) for one in read_students_csv(tiny.path / "students.csv").students] == [
        ("bär", "Jörg")
    ]
