"""A column of the list of students that is not known, or stands twice, is named with those that are needed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import write_zip
from test_collect import placed, work

from autograder.grading.collecting.collect import collect
from autograder.grading.grading_errors import GradingError
from autograder.grading.table.students_csv import read_students_csv
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

ADA = ("ada", "Ada", "Lovelace", "ada@uni.example")


@pytest.mark.parametrize("header", cases(__file__, "a_header_in_other_letters_is_known"))
def test_a_header_in_other_letters_is_known(tmp_path: Path, header: str) -> None:
    (tmp_path / "list.csv").write_text(f"{header}\nada,Ada,Lovelace,ada@uni.example\n")
    file = read_students_csv(tmp_path / "list.csv")
    assert [(one.id, one.first_name, one.last_name, one.email) for one in file.students] == [ADA]
    assert file.unknown == ()


@pytest.mark.parametrize(("text", "said"), cases(__file__, "a_list_that_leaves_open_who_is_meant_is_refused"))
def test_a_list_that_leaves_open_who_is_meant_is_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "list.csv").write_text(text)
    with pytest.raises(GradingError, match=said):
        read_students_csv(tmp_path / "list.csv")


def test_a_column_without_a_meaning_is_named_and_the_student_is_found(
    tiny: TinyClass, tmp_path: Path
) -> None:
    """The student was not found before, and nothing said that the names of the columns were not known."""
    file = {"lovelaceada_501_7001_lab_1_2.ipynb": work(tiny, 4)}
    (tiny.path / "students.csv").write_text("id,Nome,Cognome,Canvas\nal01,Ada,Lovelace,501\n")
    report = collect(tiny.path, [write_zip(tmp_path / "c.zip", file)])
    assert any("no meaning, except in collect --names: Nome, Cognome" in note for note in report.notes)
    assert placed(report).keys() == {"al01"}
    (tiny.path / "students.csv").write_text("ID,First Name,Last Name\nal01,Ada,Lovelace\n")
    report = collect(tiny.path)
    assert (report.exit_code, report.notes) == (0, ())


def test_lists_of_systems_are_read_as_they_are(tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text(
        "Student,ID,SIS User ID,SIS Login ID,Section,Quiz,Quiz\n    Points Possible,,,,,10,10\n"
        '"Lovelace, Ada",501,S1,ada,Mon,,\n"Student, Test",9,,x,Mon,,\n'
    )
    file = read_students_csv(tmp_path / "list.csv")
    assert [(one.id, one.name, dict(one.lms), one.section) for one in file.students] == [
        ("ada", "Ada Lovelace", {"canvas": "501"}, "Mon")
    ]
    assert file.unknown == ()


@pytest.mark.parametrize(
    ("text", "student"),
    cases(__file__, "names_addresses_and_sections_of_a_system_are_read"),
)
def test_names_addresses_and_sections_of_a_system_are_read(
    tmp_path: Path, text: str, student: tuple[str, str, str, str, tuple[str, ...]]
) -> None:
    (tmp_path / "list.csv").write_text(text, encoding="utf-8")
    (one,) = read_students_csv(tmp_path / "list.csv").students
    assert (one.id, one.first_name, one.last_name, one.email, one.sections) == (*student[:4], set(student[4]))
