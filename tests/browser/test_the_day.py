"""The instructor's day: a class of forty hands in through four systems and by hand, with every oddity.

It is collected, graded, graded by hand in formgrader, reported and returned, and every number in every output is
compared with what nbgrader's own gradebook says.
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
from typing import TYPE_CHECKING, Any

import msgspec
import pytest
from bs4 import BeautifulSoup
from click.testing import CliRunner
from nbgrader.api import Gradebook

sys.path.insert(0, str(Path(__file__).parents[1] / "grading"))
sys.path.insert(0, str(Path(__file__).parents[1] / "grading" / "day"))
from formgrader import Formgrader
from handed_in import BY_HAND as ODD
from handed_in import DUE, Pupil, hand_in, pupils, put_by_hand, roster
from instructor import add_question, due, penalty
from server_of_a_test import jupyter_server
from tiny_class import QUIET, TALKER, FakeEngine, TinyClass, make_tiny_class

from autograder.cli import cli
from autograder.grading.running import engine, sandboxing

if TYPE_CHECKING:
    from collections.abc import Callable

    from playwright.sync_api import Page

pytestmark = [
    pytest.mark.browser,
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning"),
]
COUNT = 40
BY_HAND = 4
"""How many are graded by hand."""


def points(pupil: Pupil) -> tuple[int, int]:
    """What the judge gives for the two exercises."""
    return pupil.place % 11, (3 * pupil.place) % 11


def run(*arguments: object) -> str:
    """What a command prints."""
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exit_code in (0, 2), result.output
    return result.output


def in_gradebook(tiny: TinyClass) -> dict[str, float]:
    """The final points of everybody, as nbgrader exports them."""
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        found = {student.id: 0.0 for student in book.students}
        for one in book.assignment_submissions("lab_1_2"):
            submission: Any = one
            late = submission.late_submission_penalty or 0.0
            found[submission.student.id] = max(0.0, submission.score - late)
    return found


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> TinyClass:
    """A class without submissions, with a list of students, a due date and a question that a person grades.

    Nothing is executed: the answers say what comes of them. All else is as it is, the version of the course included,
    so that formgrader, in a process of its own, finds the results that a command has left.
    """
    fake = FakeEngine()
    monkeypatch.setattr(engine, "execute_all", fake.execute_all)
    monkeypatch.setattr(sandboxing, "require", lambda _: None)
    tiny = TinyClass(make_tiny_class(tmp_path / "made"))
    penalty(tiny)
    due(tiny, DUE)
    add_question(tiny)
    (tiny.path / "students.csv").write_text(roster(pupils(COUNT)), encoding="utf-8")
    return tiny


def work_of(tiny: TinyClass) -> Callable[[Pupil, bool], str]:
    """What makes a student's notebook, of an earlier attempt where the flag is set."""

    def work(pupil: Pupil, is_earlier: bool) -> str:
        path = tiny.submit("x", *((0, 1) if is_earlier else points(pupil)))
        text = path.read_text().replace("YOUR ANSWER HERE", "Because.")
        for part in (path, path.parent, path.parent.parent):
            part.unlink() if part.is_file() else part.rmdir()
        return text

    return work


def collect(tiny: TinyClass, class_: list[Pupil], folder: Path) -> list[Path]:
    """Collect what came through the systems."""
    archives = hand_in(folder, class_, work_of(tiny))
    said = run("collect", tiny.path, *archives, "--timezone", "UTC")
    assert f"{sum(bool(pupil.lms) for pupil in class_)} placed, 0 unchanged, " in said, said
    assert "not placed   moodle.zip/Guest User_999" in said
    for reason in ("its name leads out of the archive", "it is a link", "unpacks to 60 MB"):
        assert said.count(reason) == 1, reason
    missing = sorted(pupil.id for pupil in class_ if not pupil.lms)
    assert f"nothing of   lab_1_2: {', '.join(missing)}" in said
    return archives


def grade_by_hand(formgrader: Formgrader, class_: list[Pupil], expected: dict[str, float]) -> dict[str, str]:
    """Give points and comments to the first submissions that formgrader shows; the comments."""
    by_name = {f"{pupil.last}, {pupil.first}": pupil for pupil in class_}
    comments = {}
    formgrader.first_submission("lab_1_2")
    for given in range(1, BY_HAND + 1):
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


def test_the_whole_day(tiny: TinyClass, page: Page, tmp_path: Path) -> None:
    class_ = pupils(COUNT)
    archives = collect(tiny, class_, tmp_path)
    late, with_extension = class_[2].id, class_[3].id

    # What would come of it, which leaves the results for whoever enters them: formgrader's button, for one student.
    run("grade", tiny.path, "--dry-run")
    server = jupyter_server(["jupyter", "server"], "teacher", tmp_path, os.environ, tiny.path)
    with server as address:
        formgrader = Formgrader(page, address, "teacher")
        line = formgrader.autograde("lab_1_2", class_[4].id)
        assert f"{sum(points(class_[4]))} / 25" in line.inner_text()
        assert sum(in_gradebook(tiny).values()) == sum(points(class_[4]))

        # Some bring their work themselves.
        put_by_hand(tiny.path / "submitted", class_, work_of(tiny))
        said = run("grade", tiny.path)
        for oddity in (
            "s33/lab_1_2/lab_1_2 (1).ipynb was left out",
            "s34/lab_1_2/lab_1_2.ipynb was called lab_1_2/lab_1_2 (1).ipynb and is graded",
            "s35/lab_1_2/lab_1_2.ipynb was called lab_1_2.ipynb and is graded",
            "Bob and bob are two students",
            "the folder José was renamed",
            "submitted/all.zip: whose it is cannot be seen",
            "submitted/lab_1_2.ipynb: whose it is cannot be seen",
            f"{len(ODD)} notebooks run, {COUNT - 1 - len(ODD)} unchanged",
        ):
            assert oddity in said, said
        with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
            book.grant_extension("lab_1_2", with_extension, days=2)
        expected = {pupil.id: float(sum(points(pupil))) if pupil.hands_in else 0.0 for pupil in class_}
        comments = grade_by_hand(formgrader, class_, expected)
    expected[late] = 0.0

    output = run("grade", tiny.path, "--json")
    truth = in_gradebook(tiny)
    assert truth == expected
    assert truth[with_extension] > 0
    assert DUE < class_[3].when < DUE + timedelta(days=2)

    # The machine's form, the table and the CSV file.
    machine = msgspec.json.decode(output[output.index('{"form"') :])
    assert {one["student"]: one["score"] for one in machine["submissions"]} == truth
    assert machine["totals"]["waiting_for_a_person"] == COUNT - 1 - BY_HAND
    sums = dict.fromkeys(truth, 0.0)
    for row in csv.DictReader(io.StringIO((tiny.path / "grades.csv").read_text("utf-8-sig"))):
        sums[row["student"]] += float(row["score"])
    assert sums == truth
    printed = run("grade", tiny.path)
    for student, score in truth.items():
        assert re.search(rf"^ *{student} .* {score:g}/25 *$", printed, re.MULTILINE), printed

    # The pages, with the remarks.
    for pupil in class_[:-1]:
        text = (tiny.path / "feedback" / pupil.id / "lab_1_2" / "lab_1_2.html").read_text()
        assert f"Score: {truth[pupil.id]:.1f} / 25.0" in text
        assert (comments.get(pupil.id, "Remark number") in text) is (pupil.id in comments)
    run("report", tiny.path)
    report = BeautifulSoup((tiny.path / "report.html").read_text(), "html.parser")
    lines = [[cell.get_text(strip=True) for cell in line.find_all("td")] for line in report.find_all("tr")]
    of_students = {
        line[0].rpartition("(")[2].rstrip(")"): float(line[-1]) for line in lines if len(line) == 5
    }
    assert {student: of_students[student] for student in truth} == truth

    # What goes back.
    for form in ("canvas", "moodle", "csv", "xlsx"):
        run("export", tiny.path, "--to", form)
    out = tiny.path / "export"
    canvas = list(csv.reader(io.StringIO((out / "canvas.csv").read_text())))
    assert {row[3]: float(row[-1]) for row in canvas[2:]} == truth
    moodle = list(csv.reader(io.StringIO((out / "moodle.csv").read_text())))
    assert {row[2]: float(row[-1]) for row in moodle[1:]} == truth
    worksheet = list(csv.DictReader(io.StringIO((out / "moodle-lab_1_2.csv").read_text())))
    assert {f"s{int(row['Identifier'].split()[1]) - 500:02}": float(row["Grade"]) for row in worksheet} == {
        pupil.id: truth[pupil.id] for pupil in class_ if pupil.lms == "moodle"
    }
    students = list(csv.DictReader(io.StringIO((out / "students.csv").read_text("utf-8-sig"))))
    assert {row["student"]: float(row["total"]) for row in students} == truth
    with zipfile.ZipFile(out / "grades.xlsx") as workbook:
        numbers = set(re.findall(r"<v>([^<]*)</v>", workbook.read("xl/worksheets/sheet1.xml").decode()))
    assert {f"{score:g}" for score in truth.values()} <= numbers
    for lms in ("canvas", "moodle"):
        with zipfile.ZipFile(out / f"feedback-{lms}-lab_1_2.zip") as archive:
            assert len(archive.namelist()) == sum(pupil.lms == lms for pupil in class_)

    # The next morning everything is as it was.
    again = run("collect", tiny.path, *archives, "--timezone", "UTC")
    assert "0 placed" in again
    assert tiny.grade(console=QUIET).executed == 0
    assert in_gradebook(tiny) == truth
