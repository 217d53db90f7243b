"""What goes back to an LMS has its form, and the gradebook's numbers."""

from __future__ import annotations

import csv
import io
import json
import shutil
import zipfile
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from downloads import ROSTER, read_path, write_zip
from instructor import by_person, due, penalty
from nbgrader.api import Gradebook
from own_assignment import EngineWithAsserts, write_assignment
from own_assignment import hand_in as put_own_work
from test_true_table import DUE, nbgraders_total
from tiny_class import FakeEngine, TinyClass

from autograder.cli import cli
from autograder.grading.collecting.collect import collect
from autograder.grading.grading_errors import GradingError
from autograder.grading.reporting.export_files import ExportChoices, export
from autograder.grading.reporting.report_page import write_report
from autograder.grading.running import execution_backends

if TYPE_CHECKING:
    from pathlib import Path

TALKER = "lab_1_2-talker"
STUDENTS = ("ada", "ben", "eve", "jose", "zoe")


@pytest.fixture(scope="module")
def _graded(to_be_copied: TinyClass, tmp_path_factory: pytest.TempPathFactory) -> Path:
    klass, downloads = to_be_copied, tmp_path_factory.mktemp("downloads")
    (klass.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    penalty(klass)
    due(klass, DUE)
    one, two = klass.submit("x", 4, 7).read_text(), klass.submit("x", 10, 10).read_text()
    shutil.rmtree(klass.path / "submitted" / "x")
    canvas = {"lovelaceada_101_9001_lab_1_2-2.ipynb": one, "nunezjose_LATE_103_9002_lab_1_2.ipynb": two}
    moodle = {"Eve O'Neill_555_assignsubmission_file/lab_1_2.ipynb": two}
    worksheet = downloads / "w.csv"
    worksheet.write_text(
        "Identifier,Full name,Email address,Grade,Last modified (submission)\n"
        'Participant 555,Eve O\'Neill,eve@uni.example,,"Sunday, 11 January 2026, 2:05 PM"\n'
    )
    collect(klass.path, [write_zip(downloads / "c.zip", canvas)])
    collect(klass.path, [write_zip(downloads / "m.zip", moodle), worksheet])
    klass.submit("ben", 1, 1)
    with FakeEngine().at_work():
        klass.grade(feedback=True)
        by_person(klass, "ada", TALKER, 9.5, extra=2)
        klass.grade(feedback=True)
    return klass.path


@pytest.fixture
def graded(_graded: Path, fake_engine: FakeEngine, tmp_path: Path) -> TinyClass:
    """A class with points by hand, a late student, one without work and one whose folder was made by hand."""
    return TinyClass(shutil.copytree(_graded, tmp_path / "class"))


def rows(path: Path) -> list[list[str]]:
    return list(csv.reader(io.StringIO(path.read_text("utf-8-sig"))))


def number(cell: str) -> float | None:
    """A cell; None where it is blank, which is not zero."""
    return float(cell) if cell else None


def in_gradebook(klass: TinyClass) -> dict[str, float | None]:
    with Gradebook(f"sqlite:///{klass.path / 'gradebook.db'}") as book:
        there = {submission.student.id for submission in book.assignment_submissions("lab_1_2")}
    return {student: nbgraders_total(klass, student) if student in there else None for student in STUDENTS}


def test_the_class_is_as_it_must_be(graded: TinyClass) -> None:
    assert in_gradebook(graded) == {"ada": 18.5, "ben": 2, "eve": 0, "jose": 20, "zoe": None}


def test_canvas_takes_the_points(graded: TinyClass) -> None:
    export(graded.path, "canvas")
    header, possible, *students = rows(graded.path / "export" / "canvas.csv")
    # What Canvas's importer asks of a file: these columns in this order, and the points possible behind them.
    assert header == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "lab_1_2"]
    assert "Points Possible" in possible[0]
    assert possible[-1] == "20"
    assert {row[3]: number(row[-1]) for row in students} == in_gradebook(graded)
    assert [row[:2] for row in students[:2]] == [["Lovelace, Ada", "101"], ["Bär, Ben", "102"]]
    assert not (graded.path / "export" / "canvas.csv").read_bytes().startswith(b"\xef\xbb\xbf")


def test_canvas_takes_the_pages_under_the_names_of_its_files(graded: TinyClass) -> None:
    done = export(graded.path, "canvas")
    with zipfile.ZipFile(graded.path / "export" / "feedback-canvas-lab_1_2.zip") as archive:
        assert sorted(archive.namelist()) == [
            "lovelaceada_101_9001_lab_1_2-2.html",
            "nunezjose_LATE_103_9002_lab_1_2.html",
        ]
        page = archive.read("lovelaceada_101_9001_lab_1_2-2.html").decode()
    assert "Score: 18.5 / 20.0" in page
    assert page.index("Ada Lovelace (ada)") < page.index("<table>")
    assert any("ben, eve" in notice for notice in done.notices)
    for name in ("lovelaceada_101_9001_lab_1_2-2.html", "nunezjose_LATE_103_9002_lab_1_2.html"):
        found = read_path((name,), "canvas")
        assert found is not None
    pages = graded.path / "feedback" / "ada" / "lab_1_2"
    shutil.copy(pages / "lab_1_2.html", pages / "second.html")
    export(graded.path, "canvas")
    (pages / "second.html").unlink()
    with zipfile.ZipFile(graded.path / "export" / "feedback-canvas-lab_1_2.zip") as archive:
        of_ada = [name for name in archive.namelist() if name.startswith("lovelaceada_101_9001_")]
    assert len(set(of_ada)) == 2


def test_no_name_in_an_unpacked_zip_sends_a_page_to_somebody_else(
    tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path
) -> None:
    """Ada calls the notebook in her zip as Canvas calls Ben's, and an instructor unpacks what was handed in as zips."""
    download = tmp_path / "download"
    for name in (
        "lovelaceada_101_9001_work/barben_102_9002_lab_1_2.ipynb",
        "barben_102_9002_w.x/lab_1_2.ipynb",
    ):
        (download / name).parent.mkdir(parents=True)
        shutil.copy(tiny.submit("x"), download / name)
    shutil.rmtree(tiny.path / "submitted" / "x")
    (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    assert {one.student for one in collect(tiny.path, [download]).outcomes} == {"ada", "ben"}
    tiny.grade(feedback=True)
    export(tiny.path, "canvas")
    with zipfile.ZipFile(tiny.path / "export" / "feedback-canvas-lab_1_2.zip") as archive:
        assert archive.namelist() == ["lovelaceada_101_9001_work.html", "barben_102_9002_w.html"]


def test_moodle_takes_points_and_pages(graded: TinyClass) -> None:
    done = export(graded.path, "moodle")
    header, *students = rows(graded.path / "export" / "moodle.csv")
    assert header == ["First name", "Last name", "ID number", "Email address", "lab_1_2"]
    assert {row[2]: number(row[-1]) for row in students} == in_gradebook(graded)
    with zipfile.ZipFile(graded.path / "export" / "feedback-moodle-lab_1_2.zip") as archive:
        assert archive.namelist() == ["Eve O'Neill_555_assignsubmission_file/lab_1_2.html"]
    assert any("on lab_1_2 for ada, ben, jose:" in notice for notice in done.notices)


def test_what_would_give_points_to_nobody_is_not_offered(graded: TinyClass) -> None:
    (graded.path / "students.csv").write_text("id,moodle\nzoe,105\n")
    shutil.rmtree(graded.path / ".autograder" / "collected")
    export(graded.path, "moodle")
    assert [path.name for path in (graded.path / "export").iterdir()] == ["moodle.csv"]


def test_a_list_of_the_lms_is_filled_in_and_else_left_as_it_is(graded: TinyClass, tmp_path: Path) -> None:
    worksheet = tmp_path / "Grades-ROS.csv"
    worksheet.write_text(
        "\ufeffIdentifier,Full name,Email address,Status,Grade,Maximum Grade,Last modified (grade),Note\n"
        "Participant 1,Ada Lovelace,ada.love@uni.example,x,,20.00,-,=1\n"
        "Participant 2,Guest User,g@uni.example,x,,20.00,-,\n"
        "Participant 3,José Núñez,,x,,20.00,-,\n",
        encoding="utf-8",
    )
    done = export(graded.path, "moodle", ExportChoices(into=worksheet))
    header, ada, guest, jose = rows(graded.path / "export" / "Grades-ROS.csv")
    assert (ada[4], guest[4], jose[4]) == ("18.5", "", "20")
    assert (header[0], ada[6:], worksheet.read_text("utf-8").count("18.5")) == ("Identifier", ["-", "=1"], 0)
    assert any("Guest User" in notice for notice in done.notices)
    gradebook = tmp_path / "canvas.csv"
    for text, words in (
        ("Student,ID,Section,Lab\n", "No column for points is called lab_1_2"),
        ("a,b\n", "neither"),
    ):
        gradebook.write_text(text)
        with pytest.raises(GradingError, match=words):
            export(graded.path, "canvas", ExportChoices(into=gradebook))


def test_a_spreadsheet_has_a_line_for_each_student(graded: TinyClass) -> None:
    export(graded.path, "csv")
    header, *students = rows(graded.path / "export" / "students.csv")
    named = [dict(zip(header, row, strict=True)) for row in students]
    assert {row["student"]: number(row["total"]) for row in named} == in_gradebook(graded)
    assert {row["student"]: float(row["late_penalty"]) for row in named}["eve"] == 20
    assert [row["last_name"] for row in named] == ["Lovelace", "Bär", "O'Neill", "Núñez", "Zuse"]


def test_what_waits_and_what_is_not_graded_is_said(graded: TinyClass) -> None:
    graded.submit("ada", 2, 2)
    done = export(graded.path, "csv")
    assert any("ada/lab_1_2" in notice and "./course grade" in notice for notice in done.notices)
    graded.grade()
    done = export(graded.path, "csv")
    assert any("1 result still to be graded by a person" in notice for notice in done.notices)


def test_the_command_names_the_files(graded: TinyClass, tmp_path: Path) -> None:
    result = CliRunner().invoke(
        cli, ["export", str(graded.path), "--to", "canvas", "--output", str(tmp_path / "o")]
    )
    assert result.exit_code == 0, result.output
    assert str(tmp_path / "o" / "canvas.csv") in result.output
    assert "Canvas: Grades, Import" in result.output
    for arguments in (
        ["--to", "excel"],
        ["--to", "csv", "--assignment", "lab_9"],
        ["--to", "moodle", "--into", "x"],
    ):
        assert CliRunner().invoke(cli, ["export", str(graded.path), *arguments]).exit_code == 2


def test_an_empty_class_has_nothing_to_export(tiny: TinyClass) -> None:
    with pytest.raises(GradingError, match="Nothing was handed in"):
        export(tiny.path, "csv")


@pytest.mark.parametrize("to", ["canvas", "moodle", "csv"])
def test_absent_is_blank_unless_the_instructor_says_zero_and_excused_is_neither(
    graded: TinyClass, to: str
) -> None:
    lines = ROSTER.replace("email,canvas", "email,excused,canvas").splitlines()
    roster = [line.replace("@uni.example,", "@uni.example,,") for line in lines]
    roster += ["kim,Kim,Ek,kim@uni.example,lab_1_2,106,", "eva,Eva,Ek,eva@uni.example,,107,"]
    (graded.path / "students.csv").write_text("\n".join(roster) + "\n")
    found = {}
    for absent in ((), ("--absent", "zero")):
        result = CliRunner().invoke(cli, ["export", str(graded.path), "--to", to, *absent])
        assert result.exit_code == 0, result.output
        name = {"csv": "students"}.get(to, to)
        header, *lines = rows(graded.path / "export" / f"{name}.csv")
        place = header.index("lab_1_2")
        for row in lines:
            for student in ("ada", "eva", "kim"):
                if student in row:
                    found[student, bool(absent)] = row[place]
    excused = "EX" if to == "canvas" else ""
    assert found == {
        ("ada", False): "18.5",
        ("ada", True): "18.5",
        ("eva", False): "",
        ("eva", True): "0",
        ("kim", False): excused,
        ("kim", True): excused,
    }


def test_what_counts_can_be_said_at_any_time_and_changed_again(graded: TinyClass) -> None:
    said = graded.path / "class.toml"
    in_gradebooks = in_gradebook(graded)
    for text, ada, most in (
        ('leave_out = ["lab_1_2.listener"]', "11.5", "10"),
        ('[points]\n"lab_1_2.talker" = 20', "30", "30"),
        ("[weights]\nlab_1_2 = 0.5", "9.25", "10"),
        ("", "18.5", "20"),
    ):
        said.write_text(text)
        export(graded.path, "canvas")
        _, possible, *students = rows(graded.path / "export" / "canvas.csv")
        assert (possible[-1], {row[3]: row[-1] for row in students}["ada"]) == (most, ada), text
        graded.grade()
        of_ada = [row for row in graded.table() if row["student"] == "ada"]
        assert sum(float(row["score"]) for row in of_ada) == float(ada)
        assert sum(float(row["max"]) for row in of_ada) == float(most)
    assert in_gradebook(graded) == in_gradebooks, "the gradebook keeps what was earned"
    for text, words in (
        ('leave_out = ["lab_9.x"]', "class.toml is named lab_9.x. Known names"),
        ("points = 3", "cannot be used"),
        ("weigths = {}", "cannot be used"),
        ('[points]\n"lab_1_2.talker" = -1', "Write a number from 0"),
    ):
        said.write_text(text)
        with pytest.raises(GradingError, match=words):
            export(graded.path, "csv")


def test_the_lowest_assignments_leave_the_total_and_nothing_else(
    graded: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(execution_backends, "execute_all", EngineWithAsserts().execute_all)
    write_assignment(graded)
    for student in ("ada", "jose"):
        put_own_work(graded, student, "def add(a, b):\n    return abs(a) - abs(b)")
    (graded.path / "class.toml").write_text("drop_lowest = 1")
    report = graded.grade()
    found = {
        row.student: (row.assignment, row.score, row.max_score)
        for row in report.rows
        if row.exercise == "dropped"
    }
    # Ada and José have less of their own assignment; the others have not handed it in; Zoë nothing at all.
    assert found == {
        "ada": ("own", -3.5, -10),
        "jose": ("own", -3.5, -10),
        "ben": ("own", 0, -10),
        "eve": ("own", 0, -10),
    }
    export(graded.path, "csv")
    header, *lines = rows(graded.path / "export" / "students.csv")
    ada = dict(zip(header, next(line for line in lines if line[0] == "ada"), strict=True))
    assert [ada[name] for name in ("lab_1_2", "own", "total", "max", "dropped")] == [
        "18.5",
        "3.5",
        "18.5",
        "20",
        "own",
    ]
    export(graded.path, "canvas")
    header, *lines = rows(graded.path / "export" / "canvas.csv")
    assert next(line[5:] for line in lines if line[3] == "ada") == ["18.5", "3.5"]
    page = write_report(graded.path).read_text()
    assert "<th>left out of the total</th>" in page
    assert page.count("<td>own</td></tr>") == len(found)
    (graded.path / "class.toml").write_text("drop_lowest = 5")
    assert {row.student for row in graded.grade().rows if row.exercise == "dropped"} == {
        "ada",
        "ben",
        "eve",
        "jose",
    }
    (graded.path / "class.toml").write_text("drop_lowest = -1")
    with pytest.raises(GradingError, match="cannot be used"):
        export(graded.path, "csv")


def test_an_assistant_sees_the_students_of_their_section(graded: TinyClass) -> None:
    monday = ("ada", "zoe")
    (graded.path / "students.csv").write_text(
        "id,section\n" + "".join(f"{one},{'Monday' if one in monday else 'Tuesday'}\n" for one in STUDENTS)
    )
    for command in (["grade"], ["export", "--to", "csv"], ["report"]):
        said = CliRunner().invoke(cli, [command[0], str(graded.path), *command[1:], "--section", "Monday"])
        assert said.exit_code == 0, said.output
        if command == ["grade"]:
            assert ("Ada" in said.output, "ben" in said.output) == (True, False)
        assert "--section leaves out 3 students (3 of Tuesday)" in said.output or command == ["report"]
    assert [line[0] for line in rows(graded.path / "export" / "students.csv")[1:]] == list(monday)
    page = (graded.path / "report.html").read_text()
    assert ("(ada)" in page, "(jose)" in page) == (True, False)
    said = CliRunner().invoke(cli, ["grade", str(graded.path), "--section", "Wednesday"])
    assert (said.exit_code, "Known names: Monday, Tuesday" in said.output) == (2, True)


@pytest.mark.parametrize(("login", "points"), [("", ["", ""]), ("ada", ["18.5", ""])])
def test_who_takes_the_name_of_somebody_else_in_the_lms_does_not_get_her_points(
    graded: TinyClass, tmp_path: Path, login: str, points: list[str]
) -> None:
    gradebook = tmp_path / "canvas.csv"
    gradebook.write_text(
        f'Student,ID,SIS User ID,SIS Login ID,Section,lab_1_2\n"Lovelace, Ada",,,{login},A,\n"LOVELACE, Ada",,,,A,\n'
    )
    exported = export(graded.path, "canvas", ExportChoices(into=gradebook))
    assert [row[-1] for row in rows(graded.path / "export" / "canvas.csv")[1:]] == points
    assert any(
        "LOVELACE, Ada: each of these lines may belong to the same student" in one for one in exported.notices
    )


def test_a_person_or_a_program_reads_what_was_written_and_what_waits(
    graded: TinyClass, tmp_path: Path
) -> None:
    collect(graded.path, [write_zip(tmp_path / "late.zip", {"guest.ipynb": "{}"})])
    said = {}
    for words in (("export", "--to", "csv"), ("report",)):
        result = CliRunner().invoke(cli, [words[0], str(graded.path), *words[1:], "--json"])
        assert result.exit_code == 0, result.output
        said[words[0]] = json.loads(result.output)
    cell = "(collected.csv, line 2, cell student)"
    assert said["export"]["files"] == [
        {"path": str(graded.path / "export" / "students.csv"), "purpose": "a line for each student"}
    ]
    assert any("guest.ipynb" in one and cell in one for one in said["export"]["notices"])
    assert [one["reason"][-len(cell) :] for one in said["report"]["waiting"]] == [cell]
    assert {one["student"] for one in said["report"]["submissions"]} >= {"ada", "ben"}
    assert any("guest.ipynb" in str(one.path) and cell in one.reason for one in graded.grade().refused)
    assert cell in (graded.path / "report.html").read_text()
    result = CliRunner().invoke(cli, ["report", str(graded.path), "--json", "--without-names"])
    assert "cannot be combined with --without-names" in result.output
