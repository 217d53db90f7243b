"""The instructor's day: a class of forty hands in through five systems and by hand, with every oddity.

It hands in a lab with a question that a person grades, and an assignment of the instructor's own with plain asserts.
Three students are late, one of them with an extension, one as a list of times says; one hands in nothing, one is
excused, and the work of four has no place. All is collected, graded, graded by hand
in formgrader, reported and returned, and every number in every output is compared with nbgrader's own gradebook.
"""

from __future__ import annotations

import csv
import io
import os
import re
import sys
import zipfile
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import pytest
from bs4 import BeautifulSoup
from click.testing import CliRunner
from nbgrader.api import Gradebook
from playwright.sync_api import expect

sys.path.insert(0, str(Path(__file__).parents[1] / "grading"))
sys.path.insert(0, str(Path(__file__).parents[1] / "grading" / "day"))
from formgrader import Formgrader
from gradebook_truth import Truth, read_truth
from handed_in import BY_HAND as ODD
from handed_in import DUE, UNPLACED, Pupil, hand_in, pupils, put_by_hand, roster, times
from instructor import add_question, due, penalty
from own_assignment import EngineWithAsserts, answered, write_assignment
from server_of_a_test import jupyter_server
from tiny_class import QUIET, TALKER, TinyClass, make_tiny_class

from autograder import exercises
from autograder.cli import cli
from autograder.grading.running import execution_backends

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from playwright.sync_api import Page

pytestmark = [
    pytest.mark.browser,
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning"),
]
COUNT = 40
EXCUSED = [pupil.id for pupil in pupils(COUNT) if pupil.oddity == "excused"]
BY_HAND = 4
"""How many are graded by hand."""
LAB, OWN = "lab_1_2", "own"
ANSWERS = {
    "def add(a, b):\n    return a + b": 7.5,
    "def add(a, b):\n    return abs(a) - abs(b)": 3.5,
    "def add(a, b:": 0.0,
}
"""What is written into the instructor's own assignment, and its points by nbgrader's rules."""


def points(pupil: Pupil) -> tuple[int, int]:
    """What the judge gives for the two exercises."""
    return pupil.place % 11, (3 * pupil.place) % 11


def answer(pupil: Pupil) -> str:
    """What a student writes into the instructor's own assignment."""
    return list(ANSWERS)[pupil.place % len(ANSWERS)]


def expected_points(class_: list[Pupil]) -> dict[str, dict[str, float]]:
    """What everybody has before a person grades, without what being late costs, by assignment."""
    return {
        LAB: {pupil.id: float(sum(points(pupil))) if pupil.hands_in else 0.0 for pupil in class_},
        OWN: {pupil.id: ANSWERS[answer(pupil)] if pupil.lms else 0.0 for pupil in class_},
    }


def run(*arguments: object) -> str:
    """What a command prints."""
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exit_code in (0, 2), result.output
    return result.output


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> TinyClass:
    """A class without submissions: a list of students, a due date, a question for a person, an own assignment.

    Nothing is executed: the answers say what comes of them. All else is as it is, the version of the course included,
    so that formgrader, in a process of its own, finds the results that a command has left.
    """
    fake = EngineWithAsserts()
    monkeypatch.setattr(execution_backends, "execute_all", fake.execute_all)
    monkeypatch.setattr(execution_backends, "require_sandbox", lambda _: None)
    tiny = TinyClass(make_tiny_class(tmp_path / "made"))
    penalty(tiny)
    due(tiny, DUE)
    add_question(tiny)
    write_assignment(tiny, OWN)
    (tiny.path / "students.csv").write_text(roster(pupils(COUNT)), encoding="utf-8")
    return tiny


def work_of(tiny: TinyClass) -> Callable[[Pupil, bool], str]:
    """What makes a student's notebook, of an earlier attempt where the flag is set."""

    def work(pupil: Pupil, is_earlier: bool) -> str:
        if pupil.oddity == "other lab":
            return answered(tiny, "", OWN)
        path = tiny.submit("x", *((0, 1) if is_earlier else points(pupil)))
        text = path.read_text().replace("YOUR ANSWER HERE", "Because.")
        for part in (path, path.parent, path.parent.parent):
            part.unlink() if part.is_file() else part.rmdir()
        return text

    return work


def collect(tiny: TinyClass, class_: list[Pupil], folder: Path) -> list[Path]:
    """Collect what came through the systems: the lab with every oddity, and the own assignment."""

    def own_work(pupil: Pupil, is_earlier: bool) -> str:
        return answered(tiny, "" if is_earlier else answer(pupil), OWN)

    archives = hand_in(folder, class_, work_of(tiny))
    (folder / "times.csv").write_text(times(class_))
    said = run("collect", tiny.path, *archives, "--timezone", "UTC", folder / "times.csv")
    assert f"{sum(pupil.is_collected for pupil in class_)} placed, 0 unchanged, " in said, said
    assert "not placed   moodle.zip/Guest User_999" in said
    unknown = "canvas.zip/evil_1_2_lab_1_2.ipynb: the file's name does not identify a student"
    for reason in (unknown, "the file is a link", "it unpacks to 60 MB"):
        assert said.count(reason) == 1, reason
    assert not [*folder.rglob("evil*")], "../../evil… stays in the archive"
    check_unplaced(said, class_)
    # Whose file waits for a place has handed in something.
    settled = {"excused", *UNPLACED}
    missing = sorted(pupil.id for pupil in class_ if not (pupil.is_collected or pupil.oddity in settled))
    assert f"nothing of   lab_1_2: {', '.join(missing)}" in said
    missing = sorted(pupil.id for pupil in class_ if not pupil.lms)
    (folder / OWN).mkdir()
    others = hand_in(folder / OWN, class_, own_work, OWN, strange=False)
    said = run("collect", tiny.path, *others, "--timezone", "UTC")
    assert ", 0 not placed, 0 left out\n" in said, said
    assert f"nothing of   own: {', '.join(missing)}" in said
    return [*archives, *others]


def check_unplaced(said: str, class_: list[Pupil]) -> None:
    """Each file that waits for a place is named with its student, the reason and what to type."""
    what_to_type = {
        "py": "it is not a notebook",
        "other lab": "write the assignment under assignment in collected.csv",
        "tar.gz": "the archive cannot be read",
    }
    for pupil in class_:
        if pupil.oddity in UNPLACED:
            words = what_to_type.get(pupil.oddity, f"unpack the file into a folder named {pupil.id}")
            assert re.search(rf"canvas\.zip/\S+lab_1_2\S*[ :].*\b{pupil.id}\b.*{words}", said), said


def grade_by_hand(formgrader: Formgrader, class_: list[Pupil], expected: dict[str, float]) -> dict[str, str]:
    """Give points and comments to the first submissions that formgrader shows; the comments."""
    names = [f"{pupil.last}, {pupil.first}" for pupil in class_]
    by_name = {name: pupil for name, pupil in zip(names, class_, strict=True) if names.count(name) == 1}
    comments = {}
    formgrader.first_submission("lab_1_2")
    for given in range(1, BY_HAND + 1):
        while formgrader.name not in by_name:  # two are called so
            formgrader.next()
        pupil = by_name[formgrader.name]
        comments[pupil.id] = f"Remark number {given}: many listen."
        formgrader.give("why", given, comment=comments[pupil.id])
        expected[pupil.id] += given
        if given == BY_HAND:
            formgrader.give(TALKER, 9, extra=1)
            expected[pupil.id] += 10 - points(pupil)[0]
        formgrader.next()
    assert len(comments) == BY_HAND, "Next leads to another student each time"
    return comments


def check_tables(tiny: TinyClass, truth: Truth, output: str) -> None:
    """The machine's form, the table and the CSV file."""
    machine = msgspec.json.decode(output[output.index('{"form"') :])
    for assignment in (LAB, OWN):
        found = {one["student"]: one for one in machine["submissions"] if one["assignment"] == assignment}
        assert {student: one["score"] for student, one in found.items()} == truth.shown_of(assignment)
        late = {student: one["late_penalty"] for student, one in found.items() if one["late_penalty"]}
        assert late == {student: cost for (student, name), cost in truth.late.items() if name == assignment}
    assert machine["totals"]["waiting_for_a_person"] == sum(cell.waits for cell in truth.cells.values())
    assert machine["totals"]["score"] == sum(truth.totals.values())
    check_rows(list(csv.DictReader(io.StringIO((tiny.path / "grades.csv").read_text("utf-8-sig")))), truth)
    printed = run("grade", tiny.path)
    for student in truth.students:
        score = truth.shown(student)
        words = "–" if score is None else f"{score:g}/{35 if student not in EXCUSED else 10}"
        assert re.search(rf"^ *{student} .* {words} *$", printed, re.MULTILINE), printed


def check_rows(rows: list[dict[str, Any]], truth: Truth) -> None:
    """A line for each student and exercise, with every number of the gradebook, and none besides."""
    numbers = ("score", "max", "judge", "by_hand", "extra")
    found: dict[tuple[str, str, str], tuple[Any, ...]] = {}
    for row in rows:
        values = [None if row[name] == "" else float(row[name]) for name in numbers]
        key = row["student"], row["assignment"], row["exercise"]
        found[key] = (*values, row["waits_for_a_person"])
    expected: dict[tuple[str, str, str], tuple[Any, ...]] = {
        (*key, "late"): (-cost, 0, None, None, None, "") for key, cost in truth.late.items()
    }
    for student in truth.students:
        for assignment, cells in truth.most.items():
            for name, most in cells.items():
                cell = truth.cells.get((student, assignment, name))
                expected[student, assignment, name] = (
                    (None, 0 if student in EXCUSED and assignment == LAB else most, None, None, None, "")
                    if cell is None
                    else (cell.score, most, cell.judged, cell.by_hand, cell.extra or None, "yes" * cell.waits)
                )
    assert found == expected
    assert len(rows) == len(found)


def check_pages(tiny: TinyClass, class_: list[Pupil], truth: Truth, comments: dict[str, str]) -> None:
    """The pages, with the remarks, and the page about the class."""
    for pupil in class_:
        page_of_lab = tiny.path / "feedback" / pupil.id / LAB / f"{LAB}.html"
        assert page_of_lab.exists() is pupil.hands_in
        if pupil.hands_in:
            text = page_of_lab.read_text()
            assert f"Score: {truth.score(pupil.id, LAB):.1f} / 25.0" in text
            assert (comments.get(pupil.id, "Remark number") in text) is (pupil.id in comments)
            assert ("handed in 2026-01-11 18:00 UTC, due 2026-01-10 12:00 UTC" in text) is (
                (pupil.id, LAB) in truth.late
            )
        if pupil.lms:
            text = (tiny.path / "feedback" / pupil.id / OWN / f"{OWN}.html").read_text()
            assert f"Score: {truth.score(pupil.id, OWN):.1f} / 10.0" in text
    run("report", tiny.path)
    page = BeautifulSoup((tiny.path / "report.html").read_text(), "html.parser")
    check_unplaced(page.get_text(), class_)
    titled = page.find("h2", string="Points of each student")
    assert titled
    table = titled.find_next("table")
    assert table
    names = [cell.get_text() for cell in table.find_all("th")][1:-1]
    keys = [(assignment, name) for assignment, cells in truth.most.items() for name in cells]
    titles = {name: exercises.get(name).title if name.startswith(f"{LAB}.") else name for _, name in keys}
    assert sorted(names) == sorted(titles.values())
    lines = [[cell.get_text(strip=True) for cell in line.find_all("td")] for line in table.find_all("tr")[1:]]
    by_id = {line[0].rpartition("(")[2].rstrip(")"): line[1:] for line in lines}
    assert by_id.keys() == set(truth.students)
    for student, (*shown, total) in by_id.items():
        assert (None if total == "–" else float(total)) == truth.shown(student)
        for assignment, name in keys:
            cell = truth.cells.get((student, assignment, name))
            is_by_hand = cell and (cell.by_hand is not None or cell.extra)
            mark = "?" if cell and cell.waits else "*" if is_by_hand else ""
            none = "excused" if student in EXCUSED and assignment == LAB else "–"
            assert shown[names.index(titles[name])] == (f"{cell.score:g}{mark}" if cell else none)


def check_exports(tiny: TinyClass, class_: list[Pupil], truth: Truth) -> None:
    """What goes back to the systems, and every cell of the table of students."""
    for form in ("canvas", "moodle", "csv"):
        check_unplaced(run("export", tiny.path, "--to", form), class_)
    out = tiny.path / "export"
    with (out / "canvas.csv").open() as lines:
        assert [(row["SIS Login ID"], row[LAB]) for row in csv.DictReader(lines) if row[LAB] == "EX"] == [
            (one, "EX") for one in EXCUSED
        ]
    for name, line in (("canvas.csv", 2), ("moodle.csv", 1)):
        header, *table = csv.reader(io.StringIO((out / name).read_text()))
        who = header.index("SIS Login ID" if name == "canvas.csv" else "ID number")
        for assignment in (LAB, OWN):
            place = header.index(assignment)
            assert {row[who]: number(row[place]) for row in table[line - 1 :]} == truth.shown_of(assignment)
    for assignment in (LAB, OWN):
        for lms in ("canvas", "moodle"):
            with zipfile.ZipFile(out / f"feedback-{lms}-{assignment}.zip") as archive:
                assert len(archive.namelist()) == sum(
                    pupil.lms == lms and (assignment == OWN or pupil.is_collected) for pupil in class_
                )
    rows = list(csv.DictReader(io.StringIO((out / "students.csv").read_text("utf-8-sig"))))
    assert len(rows) == len(class_)
    for row in rows:
        check_student(row, class_, truth)


def check_student(row: dict[str, Any], class_: list[Pupil], truth: Truth) -> None:
    """A line of the table of students: who it is, and each number."""
    pupil = next(one for one in class_ if one.id == row["student"])
    assert row == {
        "student": pupil.id,
        "first_name": pupil.first,
        "last_name": pupil.last,
        "email": f"{pupil.id}@uni.example",
        **{name: row[name] for name in NUMBERS},
        "excused": row["excused"],
        "dropped": row["dropped"],
    }
    assert row["excused"] == (LAB if pupil.id in EXCUSED else "")
    assert not row["dropped"]
    waiting = sum(cell.waits for key, cell in truth.cells.items() if key[0] == pupil.id)
    assert [number(row[name]) for name in NUMBERS] == [
        truth.shown(pupil.id, LAB),
        truth.shown(pupil.id, OWN),
        truth.shown(pupil.id),
        35 if pupil.id not in EXCUSED else 10,
        truth.late.get((pupil.id, LAB), 0),
        waiting,
    ]


def number(cell: Any) -> float | None:
    """A cell; None where it is blank or excused, which is not zero."""
    return None if cell in ("", None, "EX") else float(cell)


NUMBERS = (LAB, OWN, "total", "max", "late_penalty", "waits_for_a_person")


def test_the_whole_day(tiny: TinyClass, page: Page, tmp_path: Path) -> None:
    class_ = pupils(COUNT)
    archives = collect(tiny, class_, tmp_path)
    late, with_extension = (class_[1].id, class_[2].id), class_[3].id

    # What would come of it, which leaves the results for whoever enters them: formgrader's button, for one student.
    run("grade", tiny.path, "--dry-run")
    server = jupyter_server(["jupyter", "server"], "teacher", tmp_path, os.environ, tiny.path)
    with server as address:
        formgrader = Formgrader(page, address, "teacher")
        line = formgrader.autograde(LAB, class_[4].id)
        expect(line).to_contain_text(f"{sum(points(class_[4]))} / 25")
        line = formgrader.autograde(OWN, class_[4].id)
        expect(line).to_contain_text(f"{ANSWERS[answer(class_[4])]:g} / 10")
        entered = read_truth(tiny.path)
        assert sum(entered.totals.values()) == sum(points(class_[4])) + ANSWERS[answer(class_[4])]

        # Some bring their work themselves. Two of them do not put it where it is graded, until somebody has read why.
        submitted = tiny.path / "submitted"
        put_by_hand(submitted, class_, work_of(tiny))
        said = run("grade", tiny.path)
        check_unplaced(said, class_)
        through_a_system = sum(bool(pupil.lms) + pupil.is_collected for pupil in class_)
        renamed, moved = (submitted / one / "lab_1_2/lab_1_2.ipynb" for one in ("s34", "s35"))
        not_here = "the file is not graded in this place"
        for oddity in (
            "s33/lab_1_2/lab_1_2 (1).ipynb is not graded: the notebook in the same folder is graded",
            f"s34/lab_1_2/lab_1_2 (1).ipynb: {not_here}: rename the notebook to grade to {renamed}",
            f"s35/lab_1_2.ipynb: {not_here}: move the file into {submitted}/STUDENT/ASSIGNMENT",
            "the folder José was renamed",
            f"submitted/all.zip: {not_here}, nor are 1 more files in this folder",
            f"{len(ODD) - 2} notebooks run, {through_a_system} unchanged",
        ):
            assert oddity in said, said
        (submitted / "s34/lab_1_2/lab_1_2 (1).ipynb").rename(renamed)
        moved.parent.mkdir()
        (submitted / "s35/lab_1_2.ipynb").rename(moved)
        said = run("grade", tiny.path)
        assert f"2 notebooks run, {through_a_system + len(ODD) - 2} unchanged" in said, said
        with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
            book.grant_extension(LAB, with_extension, days=2)
        expected = expected_points(class_)
        comments = grade_by_hand(formgrader, class_, expected[LAB])
    assert DUE < class_[3].when < DUE + timedelta(days=2)
    lost = {(student, LAB): expected[LAB][student] for student in late}
    expected[LAB] |= dict.fromkeys(late, 0.0)

    output = run("grade", tiny.path, "--json")
    truth = read_truth(tiny.path)
    assert {assignment: truth.of(assignment) for assignment in expected} == expected
    assert truth.late == lost
    assert truth.score(with_extension, LAB) > 0
    assert truth.total(class_[-1].id) == 0
    assert sum(cell.waits for cell in truth.cells.values()) == sum(one.hands_in for one in class_) - BY_HAND

    check_tables(tiny, truth, output)
    check_pages(tiny, class_, truth, comments)
    check_exports(tiny, class_, truth)

    # The next morning everything is as it was.
    again = run("collect", tiny.path, *archives, "--timezone", "UTC")
    assert "0 placed" in again
    assert tiny.grade(console=QUIET).executed == 0
    assert read_truth(tiny.path) == truth
