"""A list of the LMS's own keeps what the class says nothing about, and no points go into another's line or column."""

from __future__ import annotations

import csv
import io
import json
import shutil
import zipfile
from datetime import timedelta
from typing import TYPE_CHECKING

import pytest
import tiny_class
from click.testing import CliRunner
from downloads import ROSTER, write_zip
from instructor import due, penalty
from test_true_table import DUE

from autograder.cli import cli
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState
from autograder.grading.collecting.systems import EACH, LIST_FORMS
from autograder.grading.grading_errors import GradingError
from autograder.grading.reporting.export_files import ExportChoices, export
from autograder.grading.reporting.list_columns import Called, find_columns
from autograder.grading.reporting.report_page import write_report
from autograder.grading.table.spreadsheet_csv import csv_rows
from autograder.verdict import not_checked
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

CASES = cases(__file__, "list")
WORKSHEET = cases(__file__, "WORKSHEET")
CANVAS = cases(__file__, "CANVAS")
SAKAI = cases(__file__, "SAKAI")


def rows(path: Path) -> list[list[str]]:
    return list(csv.reader(io.StringIO(path.read_text("utf-8-sig"))))


@pytest.mark.parametrize(("text", "lms"), [(WORKSHEET, "moodle"), (CANVAS, "canvas"), (SAKAI, "sakai")])
def test_a_list_of_another_system_than_the_named_one_is_refused(
    klass: TinyClass, tmp_path: Path, text: str, lms: str
) -> None:
    """A worksheet of Moodle's has one column for points: of several assignments the last would have filled it."""
    into = tmp_path / "list.csv"
    into.write_text(text)
    for to in sorted({"canvas", "moodle", "sakai", "csv"} - {lms}):
        said = CliRunner().invoke(cli, ["export", str(klass.path), "--to", to, "--into", str(into)])
        assert (said.exit_code, f"--to {lms}" in said.output) == (2, True), said.output
    assert not (klass.path / "export").exists()
    export(klass.path, lms, ExportChoices(into=into))


@pytest.mark.parametrize(("text", "to"), [(WORKSHEET, "moodle"), (CANVAS, "canvas"), (SAKAI, "sakai")])
@pytest.mark.parametrize("work", ["none", "not checked"])
def test_points_that_somebody_gave_in_the_lms_stay_where_the_class_has_none(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, to: str, work: str
) -> None:
    """Ada has points there of an oral exam, and here no work, or work that could not be checked."""
    if work == "not checked":
        monkeypatch.setattr(
            tiny_class,
            "zero_points",
            lambda check, *_: not_checked(check.exercise, "", check.points, "It hung."),
        )
        klass.submit("ada", "1/0", "1/0")
        assert {row.state for row in klass.grade().rows if row.student == "ada"} == {"not_checked"}
    into = tmp_path / "list.csv"
    into.write_text(text)
    export(klass.path, to, ExportChoices(into=into))
    assert rows(klass.path / "export" / "list.csv") == rows(into)
    if work == "none":
        export(klass.path, to, ExportChoices(into=into, absent_zero=True, over=True))
        place = rows(into)[0].index("Grade" if to == "moodle" else "lab_1_2")
        assert rows(klass.path / "export" / "list.csv")[1][place] == "0"


def test_a_number_of_canvas_is_no_students_number_where_anything_else_says_who_it_is(
    klass: TinyClass, tmp_path: Path
) -> None:
    (klass.path / "students.csv").write_text("id,first_name,last_name\n101,Zoe,Zander\nbob,Bob,Bell\n")
    for student, points in (("101", 4), ("bob", 9)):
        klass.submit(student, points, 0)
    klass.grade()
    into = tmp_path / "list.csv"
    into.write_text(
        'Student,ID,SIS User ID,SIS Login ID,Section,lab_1_2\n"Bell, Bob",101,,,A,\n"Zander, Zoe",7,,,A,\n'
    )
    export(klass.path, "canvas", ExportChoices(into=into))
    assert [row[-1] for row in rows(klass.path / "export" / "list.csv")] == ["lab_1_2", "9", "4"]


def test_only_moodle_says_who_a_participant_is(klass: TinyClass, tmp_path: Path) -> None:
    """A participant's number is Moodle's for one student and one assignment: no list of students has it."""
    (klass.path / "students.csv").write_text(ROSTER.replace(",canvas,", ",moodle,"), encoding="utf-8")
    of_eve = {"Eve O'Neill_555_assignsubmission_file/lab_1_2.ipynb": klass.submit("x", 4, 4).read_text()}
    shutil.rmtree(klass.path / "submitted" / "x")
    collect(klass.path, [write_zip(tmp_path / "m.zip", of_eve)])
    klass.grade(feedback=True)
    done = export(klass.path, "moodle")
    folder = klass.path / "export"
    assert "555" not in (folder / "moodle.csv").read_text("utf-8")
    with zipfile.ZipFile(folder / "feedback-moodle-lab_1_2.zip") as pages:
        assert pages.namelist() == ["Eve O'Neill_555_assignsubmission_file/lab_1_2.html"]
    feedback = next(one for one in done.notices if "feedback" in one)
    assert "the zip has no feedback on lab_1_2 for ben:" in feedback


def test_a_doubtful_line_is_settled_by_what_the_list_has_in_it(klass: TinyClass, tmp_path: Path) -> None:
    """The advice names columns of the list; what stands there tells the two lines apart, and the number would not."""
    (klass.path / "students.csv").write_text("id,first_name,last_name,moodle\nben,Ben,Bär,\n")
    into = tmp_path / "list.csv"
    into.write_text(
        "Identifier,Full name,Email address,Grade\n"
        "Participant 31,Ben Bär,one@uni.example,\nParticipant 32,BEN BÄR,two@uni.example,\n",
        encoding="utf-8",
    )
    (said,) = export(klass.path, "moodle", ExportChoices(into=into)).notices
    assert "copy what the list has under Email address" in said
    (klass.path / "students.csv").write_text("id,first_name,last_name,moodle\nben,Ben,Bär,two@uni.example\n")
    export(klass.path, "moodle", ExportChoices(into=into))
    assert [row[-1] for row in rows(klass.path / "export" / "list.csv")[1:]] == ["", "17"]


GRADEBOOK = cases(__file__, "GRADEBOOK")


def test_columns_are_asked_for_and_no_column_that_names_a_student_is_written(
    klass: TinyClass, tmp_path: Path
) -> None:
    name = "Woche 3 - lab 1.2 (9001)"
    klass.submit("ada", 8, 10)
    klass.grade()
    into = tmp_path / "list.csv"
    into.write_text(
        GRADEBOOK.format(columns=f'"{name}",Exam 12 (9002)', possible="20,30.5", cells=","), encoding="utf-8"
    )
    command = ["export", str(klass.path), "--to", "canvas", "--into", str(into)]
    said = CliRunner().invoke(cli, command)
    assert (said.exit_code, '--column "lab_1_2=COLUMN"' in said.output) == (2, True), said.output
    for wrong in ("Final Result", "Section", "Student", "SIS Login ID", "Final Score", "Current Score"):
        said = CliRunner().invoke(cli, [*command, "--column", f"lab_1_2={wrong}"])
        assert (said.exit_code, '--column "lab_1_2=COLUMN"' in said.output) == (2, True), said.output
        assert "(read only) columns take no points: Current Score, Final Score." in said.output
    assert not (klass.path / "export").exists()
    said = CliRunner().invoke(cli, [*command, "--column", f"lab_1_2={name}"])
    assert said.exit_code == 0, said.output
    assert rows(klass.path / "export" / "list.csv")[2][5:] == ["18", "", "7.0", "7.0"]
    said = CliRunner().invoke(cli, [*command[:4], "--column", f"lab_1_2={name}"])
    assert (said.exit_code, "--column names a column of the list in --into" in said.output) == (2, True)


@pytest.mark.parametrize("name", cases(__file__, "a_column_that_has_the_assignments_name_or_title_is_found"))
def test_a_column_that_has_the_assignments_name_or_title_is_found(
    klass: TinyClass, tmp_path: Path, name: str
) -> None:
    klass.submit("ada", 8, 10)
    klass.grade()
    into = tmp_path / "list.csv"
    columns = f'Lab 1.20 (9000),"{name}",Lab 1 (9003)'
    into.write_text(GRADEBOOK.format(columns=columns, possible="1,20,3", cells=",,"), encoding="utf-8")
    export(klass.path, "canvas", ExportChoices(into=into))
    assert rows(klass.path / "export" / "list.csv")[2][5:8] == ["", "18", ""]


def test_all_columns_that_are_missing_are_named_at_once() -> None:
    header = ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "First lab (1)", "Second lab (2)"]
    form = next(one for one in LIST_FORMS if one.lms == "canvas" and one.points == EACH)
    with pytest.raises(GradingError) as caught:
        find_columns([header], form, list(map(Called, ("first_lab_1", "second_lab_2", "third"))))
    for word in ("first_lab_1, second_lab_2, third", '--column "first_lab_1=COLUMN"', "third="):
        assert word in str(caught.value)


def test_canvas_own_late_penalty_is_warned_of_where_work_is_late(klass: TinyClass) -> None:
    said = "Canvas may subtract its own late penalty"
    penalty(klass)
    due(klass, DUE)
    assert not any(said in one for one in export(klass.path, "canvas").notices)
    late = DUE + timedelta(hours=30)
    (klass.path / "submitted" / "ben" / "lab_1_2" / "timestamp.txt").write_text(
        f"{late:%Y-%m-%d %H:%M:%S} UTC"
    )
    klass.grade()
    assert sum(said in one for one in export(klass.path, "canvas").notices) == 1
    assert said in write_report(klass.path).read_text()
    (klass.path / "students.csv").write_text("id,first_name\nben,Ben\n")
    assert not any(said in one for one in export(klass.path, "moodle").notices)
    assert sum(said in one for one in export(klass.path, "canvas").notices) == 1


@pytest.mark.parametrize("name", CASES)
def test_what_an_export_changes_in_a_list(klass: TinyClass, tmp_path: Path, name: str) -> None:
    """The cases are in the table ``list`` of test_filled_lists.toml."""
    case = CASES[name]
    roster = "id,first_name,last_name,canvas,excused\nada,Ada,Lovelace,101,\nben,Ben,Bar,102,\n"
    (klass.path / "students.csv").write_text(roster)
    (klass.path / "class.toml").write_text(case.get("class", ""))
    into = tmp_path / "list.csv"
    for text in case.get("earlier", ()):  # lists that were filled in and uploaded before
        into.write_text(text, encoding="utf-8")
        export(klass.path, "", ExportChoices(into=into))
    (klass.path / "students.csv").write_text(case.get("students", roster), encoding="utf-8")
    klass.submit("ada", 8, 10)
    klass.grade()
    into.write_text(case["list"], encoding="utf-8")
    words = ["export", str(klass.path), "--into", str(into), *case.get("options", ())]
    said = CliRunner().invoke(cli, words)
    assert said.exit_code == case.get("exit", 0), said.output
    for sentence in case.get("says", ()):
        assert sentence in said.output, said.output
    for sentence in case.get("never", ()):
        assert sentence not in said.output, said.output
    there = klass.path / "export" / "list.csv"
    if (cells := case.get("cells")) is not None:
        place = case.get("column", -1)
        assert tuple(row[place] for row in csv_rows(there.read_bytes())[0][-2:]) == cells
        assert (klass.path / "export" / "list.before.csv").read_text("utf-8") == case["list"]
    elif not case.get("earlier"):
        assert not there.exists()


def test_who_has_a_page_after_a_repair_by_hand_and_an_empty_file_is_named(
    klass: TinyClass, tmp_path: Path
) -> None:
    """A second file without answers is graded because it is newer, and a person repairs it in ``submitted``."""
    written, blank = klass.submit("x", 7, 7).read_text(), json.dumps(klass.released())
    shutil.rmtree(klass.path / "submitted" / "x")
    for number, (day, text) in enumerate((("1", written), ("2", blank)), 1):
        (tmp_path / f"{number}.csv").write_text(
            f"user_id,login_id,name,submitted_at\n101,ada,Ada Lovelace,2026-01-0{day}T10:00:00Z\n"
        )
        zipped = write_zip(tmp_path / f"{number}.zip", {f"lovelaceada_101_900{number}_lab_1_2.ipynb": text})
        report = collect(klass.path, [zipped, tmp_path / f"{number}.csv"])
    (placed,) = report.having(LineState.PLACED)
    assert (
        "nothing is written in it, and 1.zip/lovelaceada_101_9001_lab_1_2.ipynb has answers" in placed.reason
    )
    with (klass.path / "submitted" / "ada" / "lab_1_2" / "lab_1_2.ipynb").open("a") as file:
        file.write("\n")
    collect(klass.path)
    klass.grade(feedback=True)
    export(klass.path, "canvas")
    with zipfile.ZipFile(klass.path / "export" / "feedback-canvas-lab_1_2.zip") as pages:
        assert pages.namelist() == ["lovelaceada_101_9002_lab_1_2.html"]
