"""Who has points, who has none and who needs none: the same in every table, and said where a line is not as meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import tiny_class
from bs4 import BeautifulSoup
from downloads import ROSTER
from own_assignment import EngineWithAsserts, hand_in, write_assignment

from autograder.grading.grading_errors import GradingError
from autograder.grading.reporting.export_files import ExportChoices, export
from autograder.grading.reporting.report_page import write_report
from autograder.grading.running import execution_backends
from autograder.verdict import not_checked

if TYPE_CHECKING:
    from tiny_class import TinyClass


def students(klass: TinyClass) -> dict[str, dict[str, str]]:
    """The lines of the table of students, by their ids."""
    return {line["student"]: line for line in klass.table("export/students.csv")}


def test_zero_for_the_absent_is_for_nobody_else(klass: TinyClass, monkeypatch: pytest.MonkeyPatch) -> None:
    roster = ROSTER.replace("email,", "email,excused,").replace("@uni.example,", "@uni.example,,")
    (klass.path / "students.csv").write_text(roster.replace("zoe@uni.example,", "zoe@uni.example,lab_1_2"))
    monkeypatch.setattr(
        tiny_class, "zero_points", lambda check, *_: not_checked(check.exercise, "", check.points, "It hung.")
    )
    klass.submit("eve", "1/0", "1/0")
    klass.grade()
    export(klass.path, "csv", ExportChoices(absent_zero=True))
    shown = {name: (line["lab_1_2"], line["total"]) for name, line in students(klass).items()}
    assert shown == {
        "ada": ("0", "0"),
        "ben": ("17", "17"),
        "eve": ("", ""),
        "jose": ("0", "0"),
        "zoe": ("", ""),
    }


def test_who_is_excused_from_what_there_is_not_is_named(klass: TinyClass) -> None:
    """A slip in the name would cost Ada the points that she need not earn."""
    (klass.path / "students.csv").write_text(
        "id,section,excused\nada,A,lab_1_2 lab_12\nben,B,\neve,B,lab_12\njose,A,\nzoe,A,\n"
    )
    said = (
        "students.csv excuses {} from lab_12, but this assignment does not exist, so the entry excuses no student. "
        "The class has: lab_1_2"
    )
    assert said.format("ada, eve") in export(klass.path, "csv").notices
    assert said.format("ada") in export(klass.path, "csv", ExportChoices(sections=["A"])).notices
    assert said.format("ada, eve") in klass.grade().notices
    assert said.format("ada, eve") in write_report(klass.path).read_text()
    assert "lab_12" not in write_report(klass.path, names=False).read_text()
    (klass.path / "students.csv").write_text("id,excused\nada,lab_1_2\nben,\n")
    assert not export(klass.path, "csv").notices


def test_an_assignment_whose_source_is_damaged_is_named_and_not_left_out_in_silence(
    klass: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(execution_backends, "execute_all", EngineWithAsserts().execute_all)
    write_assignment(klass)
    hand_in(klass, "ben", "def add(a, b):\n    return a + b")
    klass.grade()
    source = klass.path / "source" / "own" / "own.ipynb"
    source.write_text("{")
    said = f"own is left out of all students' points: {source} is not a notebook"
    assert any(notice.startswith(said) for notice in export(klass.path, "csv").notices)
    assert said in BeautifulSoup(write_report(klass.path).read_text(), "html.parser").get_text()
    without_names = BeautifulSoup(write_report(klass.path, names=False).read_text(), "html.parser").get_text()
    assert "own is left out of all students' points" in without_names
    assert str(klass.path) not in without_names
    with pytest.raises(GradingError, match=r"own\.ipynb is not a notebook"):
        export(klass.path, "csv", ExportChoices(assignments=["own"]))
    with pytest.raises(GradingError, match="No assignment that a student has handed in is named lab_9"):
        export(klass.path, "csv", ExportChoices(assignments=["lab_9"]))
    (klass.path / "source" / "lab_1_2" / "lab_1_2.ipynb").write_text("{")
    with pytest.raises(GradingError, match="is not a notebook"):
        export(klass.path, "csv")
    with pytest.raises(GradingError, match="is not a notebook"):
        write_report(klass.path)


def test_what_could_not_be_checked_is_blank_until_it_could(klass: TinyClass) -> None:
    """The judge of Eve's work died: that is nobody's zero, neither here nor in a later run that is not about her."""
    klass.submit("eve", "'die'", "'die'")
    klass.grade()
    for grade in (lambda: None, lambda: klass.grade(students=["ben"], again=True)):
        grade()
        export(klass.path, "csv", ExportChoices(absent_zero=True))
        assert (students(klass)["eve"]["lab_1_2"], students(klass)["eve"]["total"]) == ("", "")
    of_eve = [row for row in klass.table() if row["student"] == "eve"]
    assert {(row["score"], row["state"], row["waits_for_a_person"]) for row in of_eve} == {
        ("", "not_graded", "")
    }
    klass.submit("eve", 4, 10)
    klass.grade()
    export(klass.path, "csv")
    assert students(klass)["eve"]["total"] == "14"
    assert students(klass)["eve"]["waits_for_a_person"] == "0"
