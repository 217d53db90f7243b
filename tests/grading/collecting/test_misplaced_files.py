"""What lies a little beside its place in ``submitted`` is graded or has a line: a browser's habit costs nothing."""

from __future__ import annotations

import unicodedata
from typing import TYPE_CHECKING

import pytest
from downloads import zipped
from nbformat.v4 import new_code_cell, new_markdown_cell
from own_assignment import marked, write_assignment
from tiny_class import LISTENER, TALKER

from autograder.grading.grading_errors import MasterUnusable

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass

    from autograder.grading.reporting.grade_report import GradeReport


def refused(report: GradeReport) -> str:
    return "\n".join(f"{one.path.name}: {one.reason}" for one in report.refused)


def test_beside_the_notebook_it_is_mentioned(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    path = tiny.submit("ada", 4, 7)
    path.with_name("lab_1_2 (1).ipynb").write_text("{}")
    report = tiny.grade()
    assert any("lab_1_2 (1).ipynb is not graded" in notice for notice in report.notices)
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}


def test_two_numbered_ones_need_a_decision(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    path = tiny.submit("ada", 4, 7)
    path.with_name("lab_1_2 (2).ipynb").write_bytes(path.read_bytes())
    path.rename(path.with_name("lab_1_2 (1).ipynb"))
    report = tiny.grade()
    assert (
        "lab_1_2 (1).ipynb: the file is not graded in this place, nor are 1 more files in this folder"
        in refused(report)
    )
    assert f"rename the notebook to grade to {path}" in refused(report)
    assert report.exit_code == 2


def test_one_folder_too_high_is_named_and_stays_there(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    path = tiny.submit("ada", 4, 7)
    high = path.rename(path.parent.parent / "lab_1_2.ipynb")
    report = tiny.grade()
    assert (
        f"lab_1_2.ipynb: the file is not graded in this place: move the file into {tiny.path}/submitted/STUDENT"
        in refused(report)
    )
    assert (report.exit_code, high.exists()) == (2, True)


def test_loose_files_and_zips_are_named(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    (tiny.path / "submitted" / "lab_1_2.ipynb").write_text("{}")
    (tiny.path / "submitted" / "ben" / "lab_1_2").mkdir(parents=True)
    (tiny.path / "submitted" / "ben" / "lab_1_2" / "work.zip").write_bytes(zipped({"a": "b"}))
    (tiny.path / "submitted" / "moodle.zip").write_bytes(zipped({"a": "b"}))
    report = tiny.grade()
    assert {one.path.name for one in report.refused} == {"lab_1_2.ipynb", "work.zip"}
    assert "nor are 1 more files in this folder" in refused(report)
    assert "./course collect" in refused(report)


def test_a_name_as_a_mac_writes_it_is_the_same_name(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit(unicodedata.normalize("NFD", "José"), 4, 7)
    report = tiny.grade()
    assert report.exit_code == 0
    assert tiny.scores("José") == {TALKER: 4, LISTENER: 7}
    assert any("José" in notice for notice in report.notices)


def test_who_asks_for_one_student_hears_of_that_one(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    (tiny.path / "submitted" / "a*").mkdir()
    assert tiny.grade().exit_code == 2
    report = tiny.grade(students=["ada"])
    assert (report.refused, report.exit_code) == ((), 0)


@pytest.mark.parametrize("folder", ["ada/lab_1_2", "ada"])
def test_a_thousand_notebooks_beside_one_are_one_line(
    tiny: TinyClass, fake_engine: FakeEngine, folder: str
) -> None:
    tiny.submit("ada", 4, 7)
    for number in range(1_000):
        (tiny.path / "submitted" / folder / f"beside_{number}.ipynb").touch()
    report = tiny.grade()
    lines = [*report.notices, *(one.reason for one in report.refused)]
    assert (len(lines), "nor are 999 more" in lines[0]) == (1, True)
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}


def test_an_assignment_that_the_judge_cannot_grade_holds_up_no_other(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    write_assignment(tiny, "own", [marked(new_code_cell("check('gone', Talker)"), "own", 3)])
    tiny.submit("ada", 4, 7)
    report = tiny.grade()
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}
    assert "has points, but" in refused(report)
    assert report.exit_code == 2
    assert tiny.grade(assignments=["lab_1_2"]).exit_code == 0
    with pytest.raises(MasterUnusable, match="own"):
        tiny.grade(assignments=["own"])


def test_an_assignment_for_persons_alone_is_in_the_table(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    question = marked(new_markdown_cell("Why?"), "own", 3)
    question.metadata["nbgrader"].update(solution=True, locked=False)
    write_assignment(tiny, "own", [question])
    path = tiny.path / "submitted" / "ada" / "own" / "own.ipynb"
    path.parent.mkdir(parents=True)
    text = (tiny.path / "release" / "own" / "own.ipynb").read_text()
    path.write_text(text.replace("YOUR ANSWER HERE", "Because."))
    report = tiny.grade()
    assert [(row.exercise, row.max_score, row.state, row.waits) for row in report.rows] == [
        ("own", 3, "waits", True)
    ]
