"""The instructor's day: a class handed in through four systems, collected, graded, partly by hand, reported, returned.

Every number in every output is compared with what nbgrader's own gradebook says.
"""

from __future__ import annotations

import contextlib
import csv
import io
import re
import shlex
import subprocess
import sys
import zipfile
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import pytest
from bs4 import BeautifulSoup
from click.testing import CliRunner
from conftest import QUIET
from downloads import write_zip
from handed_in import DUE, Pupil, hand_in, pupils, roster
from nbgrader.api import Gradebook
from test_true_table import add_question, by_person, due, penalty

from autograder.cli import cli
from autograder.grading.running import sandboxing

if TYPE_CHECKING:
    from conftest import FakeEngine, TinyClass

pytestmark = pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning")
TALKER = "lab_1_2-talker"
GUIDE = Path(__file__).parents[3] / "docs" / "instructors-guide.md"
COUNT = 16


def points(pupil: Pupil) -> tuple[int, int]:
    return pupil.place % 11, (3 * pupil.place) % 11


def run(*arguments: object) -> str:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exit_code in (0, 2), result.output
    return result.output


def gradebook(tiny: TinyClass) -> dict[str, float]:
    """The final points of everybody, as nbgrader exports them."""
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        found = {student.id: 0.0 for student in book.students}
        for one in book.assignment_submissions("lab_1_2"):
            submission: Any = one
            late = submission.late_submission_penalty or 0.0
            found[submission.student.id] = max(0.0, submission.score - late)
    return found


@pytest.fixture
def unboxed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is executed, so no box is needed."""
    monkeypatch.setattr(sandboxing, "require", lambda _: None)


def test_the_whole_day(tiny: TinyClass, fake_engine: FakeEngine, unboxed: None, tmp_path: Path) -> None:
    class_ = pupils(COUNT)
    penalty(tiny)
    due(tiny, DUE)
    add_question(tiny)
    (tiny.path / "students.csv").write_text(roster(class_), encoding="utf-8")

    def work(pupil: Pupil, is_earlier: bool) -> str:
        path = tiny.submit("x", *((0, 0) if is_earlier else points(pupil)))
        text = path.read_text().replace("YOUR ANSWER HERE", "Because.")
        for part in (path, path.parent, path.parent.parent):
            part.unlink() if part.is_file() else part.rmdir()
        return text

    archives = hand_in(tmp_path, class_, work)
    said = run("collect", tiny.path, *archives, "--timezone", "UTC")
    assert f"{COUNT - 1} placed, 0 unchanged, " in said
    assert "not placed   moodle.zip/Guest User_999" in said
    assert "its name leads out of the archive" in said
    assert f"nothing of   lab_1_2: {class_[-1].id}" in said

    # One of the two who are late has an extension.
    run("grade", tiny.path)
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        book.grant_extension("lab_1_2", class_[3].id, days=2)
    for pupil in class_[4:9]:
        by_person(tiny, pupil.id, "why", pupil.place % 5)
    by_person(tiny, class_[5].id, TALKER, 9, extra=1)
    output = run("grade", tiny.path, "--json")
    truth = gradebook(tiny)

    expected = {pupil.id: float(sum(points(pupil))) if pupil.lms else 0.0 for pupil in class_}
    for pupil in class_[4:9]:
        expected[pupil.id] += pupil.place % 5
    expected[class_[5].id] += 10 - points(class_[5])[0]
    expected[class_[2].id] = 0
    assert truth == expected
    assert truth[class_[3].id] > 0
    assert DUE < class_[3].when < DUE + timedelta(days=2)

    # The machine's form, the table and the CSV file.
    machine = msgspec.json.decode(output[output.index('{"form"') :])
    assert {one["student"]: one["score"] for one in machine["submissions"]} == truth
    assert machine["totals"]["waiting_for_a_person"] == COUNT - 1 - 5
    sums = dict.fromkeys(truth, 0.0)
    for row in csv.DictReader(io.StringIO((tiny.path / "grades.csv").read_text("utf-8-sig"))):
        sums[row["student"]] += float(row["score"])
    assert sums == truth
    printed = run("grade", tiny.path)
    for student, score in truth.items():
        assert re.search(rf"^ *{student} .* {score:g}/25 *$", printed, re.MULTILINE), printed

    # The pages.
    for pupil in class_[:-1]:
        page = (tiny.path / "feedback" / pupil.id / "lab_1_2" / "lab_1_2.html").read_text()
        assert f"Score: {truth[pupil.id]:.1f} / 25.0" in page
    run("report", tiny.path)
    page = BeautifulSoup((tiny.path / "report.html").read_text(), "html.parser")
    lines = [[cell.get_text(strip=True) for cell in line.find_all("td")] for line in page.find_all("tr")]
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
    for lms in ("canvas", "moodle"):
        with zipfile.ZipFile(out / f"feedback-{lms}-lab_1_2.zip") as archive:
            assert len(archive.namelist()) == sum(pupil.lms == lms for pupil in class_)

    # The next morning everything is as it was.
    again = run("collect", tiny.path, *archives, "--timezone", "UTC")
    assert "0 placed" in again
    assert tiny.grade(console=QUIET).executed == 0
    assert gradebook(tiny) == truth


def commands(text: str) -> list[str]:
    """The lines that a reader of a page is to type."""
    blocks = re.findall(r"^```console\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [line[2:] for block in blocks for line in block.splitlines() if line.startswith("$ ")]


def test_every_command_of_the_guide_runs(
    tiny: TinyClass, fake_engine: FakeEngine, unboxed: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from jupyter_core.application import NoStart
    from nbgrader.apps import NbGraderApp

    (tmp_path / "Downloads").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "Downloads" / "Grades-lab_1_2.csv").write_text(
        "Identifier,Full name,Email address,Grade\nParticipant 1,Ada Lovelace,ada@uni.example,\n"
    )
    (tiny.path / "students.csv").write_text(
        "id,first_name,last_name,email\nada,Ada,Lovelace,ada@uni.example\n"
    )
    notebook = tiny.submit("x", 4, 7)
    write_zip(
        tmp_path / "Downloads" / "submissions.zip", {"lovelaceada_1_2_lab_1_2.ipynb": notebook.read_bytes()}
    )
    for part in (notebook, notebook.parent, notebook.parent.parent):
        part.unlink() if part.is_file() else part.rmdir()
    ran = []
    for command in commands(GUIDE.read_text(encoding="utf-8")):
        words = shlex.split(command.replace("~/robotics-2025", str(tiny.path)).replace("~", str(tmp_path)))
        if words[0] == "cd":
            monkeypatch.chdir(words[1])
            continue
        assert Path(words[0]).name == "course", command
        name = words[1]
        if name == "new-class":
            # The class of this test is there already: a real one in another place, of one lab.
            words[2:] = [str(tmp_path / "another"), "--assignment", "lab_1_2"]
            subprocess.run([sys.executable, "-m", "autograder", *words[1:]], check=True, capture_output=True)
        elif name == "renew-class":
            run(*words[1:2], tmp_path / "another", *words[3:])
        elif name == "nbgrader":
            NbGraderApp.clear_instance()
            application = NbGraderApp.instance()
            application.initialize(words[2:])
            with contextlib.suppress(NoStart):  # that is how a command within nbgrader ends
                application.start()
            NbGraderApp.clear_instance()
        else:
            if name == "compare":  # of a class that has been graded twice
                by_person(tiny, "ada", TALKER, 5)
                run("grade", tiny.path)
                by_person(tiny, "ada", TALKER, 4)
                run("grade", tiny.path)
            result = CliRunner().invoke(cli, words[1:])
            assert result.exit_code == 0, f"{command}: {result.output}"
        ran.append(name)
    assert {"new-class", "collect", "grade", "report", "export", "nbgrader"} <= set(ran)
    assert (tmp_path / "another" / "release" / "lab_1_2" / "lab_1_2.ipynb").is_file()
    assert (tiny.path / "nbgrader_export.csv").is_file()
    filled = (tiny.path / "export" / "Grades-lab_1_2.csv").read_text()
    assert "Participant 1,Ada Lovelace,ada@uni.example,11" in filled
