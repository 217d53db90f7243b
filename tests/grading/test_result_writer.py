"""The one conversion: what it leaves behind is what nbgrader's own steps would, and it fails closed."""

from __future__ import annotations

import json
import re
import shutil
import sqlite3
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat
import pytest
from bs4 import BeautifulSoup
from nbgrader.preprocessors import AssignLatePenalties, GetGrades, SaveAutoGrades
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass

from autograder.execution.executed_cells import CellCheck
from autograder.grading.classes import gradebook_writing
from autograder.grading.classes.class_directory import ClassDirectory, Submission
from autograder.grading.classes.gradebook_reading import read_entries
from autograder.grading.grading_task import points
from autograder.grading.returning.feedback_pages import mark_waiting
from autograder.grading.returning.page_exporter import PageExporter
from autograder.grading.returning.sanitize import make_harmless
from autograder.grading.tasks import graded_notebooks
from autograder.grading.tasks.submission_times import handed_in_at
from autograder.verdict import State, Verdict
from tests.cases import cases

if TYPE_CHECKING:
    from sqlalchemy import Connection

pytestmark = pytest.mark.usefixtures("fake_engine")


@pytest.mark.parametrize("worth", [7, 150, 1000, 99_999])
def test_points_are_written_with_all_their_digits(worth: int) -> None:
    """What nbgrader reads from the cell is compared with what the judge gave."""
    check = CellCheck("lab.one", "One", points=3, worth=worth, limit=2)
    verdict = Verdict("lab.one", "One", State.FAILED, 1, 3)
    given = points(check, verdict)
    *_, value = graded_notebooks._graded_outputs(check, verdict, [])
    assert float(value["data"]["text/plain"]) == given


def everything(path: Path) -> dict[str, Any]:
    """What the gradebook holds, without the ids that are drawn anew in each."""
    book = sqlite3.connect(path / "gradebook.db")
    found = {}
    for table, columns in cases(__file__, "COLUMNS").items():
        found[table] = sorted(map(repr, book.execute(f"SELECT {columns} FROM {table}")))
    return found


def notebooks(path: Path) -> dict[str, Any]:
    """The files of ``autograded/``, as data, and their modes."""
    folder = path / "autograded"
    return {
        str(file.relative_to(folder)): (
            file.stat().st_mode,
            json.loads(file.read_text()) if file.suffix == ".ipynb" else file.read_bytes(),
        )
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def pages(path: Path) -> dict[str, str]:
    """The feedback pages, as a parser sees them: nbconvert parses its pages and writes them anew."""
    folder = path / "feedback"
    return {
        str(file.relative_to(folder)): str(BeautifulSoup(file.read_text(), features="html.parser"))
        for file in sorted(folder.rglob("*.html"))
    }


def enter_as_nbgrader_does(path: Path) -> None:
    """Have nbgrader's own steps enter what lies in ``autograded/``."""
    directory = ClassDirectory(path)
    for file in sorted((path / "autograded").rglob("*.ipynb")):
        names = {"student": file.parts[-3], "assignment": file.parts[-2], "notebook": file.stem}
        resources = {"nbgrader": {**names, "db_url": directory.gradebook_url}}
        notebook = nbformat.read(file, as_version=4)
        for step in (SaveAutoGrades, AssignLatePenalties):
            step(config=directory.config).preprocess(notebook, resources)


def page_as_nbgrader_makes_it(path: Path, file: Path) -> str:
    """A page by nbconvert's whole way, with what nbgrader's own step puts into the notebook."""
    directory = ClassDirectory(path)
    exporter: Any = PageExporter(config=directory.config)
    exporter.register_filter("part_of_page", lambda render, _: render())
    exporter.register_preprocessor(GetGrades, enabled=True)
    names = {"student": file.parts[-3], "assignment": file.parts[-2], "notebook": file.stem}
    notebook = nbformat.read(file, as_version=4)
    entry = read_entries(directory.gradebook_url)[names["student"], names["assignment"]]
    mark_waiting(notebook, entry.cells.get(file.stem, {}))
    why_late = entry.why_late(directory.time_zone)
    resources = {"nbgrader": {**names, "db_url": directory.gradebook_url, "why_late": why_late}}
    page: str = exporter.from_notebook_node(make_harmless(notebook), resources)[0]
    return page


@pytest.mark.parametrize("penalty", ["none", "zero"])
def test_nbgraders_own_steps_find_nothing_to_change(tiny: TinyClass, tmp_path: Path, penalty: str) -> None:
    tiny.configure(f"c.LateSubmissionPlugin.penalty_method = {penalty!r}")
    with sqlite3.connect(tiny.path / "gradebook.db") as book:
        book.execute("UPDATE assignment SET duedate = '2026-01-02 03:04:05.000000'")
    tiny.submit("ada", 10, 4)
    late = tiny.submit("ben", 7, 0).with_name("timestamp.txt")
    late.write_text("2026-01-02 05:04:05.000000 UTC")
    tiny.hand_in("cleo", "not a notebook")
    tiny.submit("dora", "'raise'").with_name("timestamp.txt").write_text("2026-01-01 05:04:05.000000 UTC")
    # A notebook that its student never touched: nbgrader comments "No response." on it.
    released = tiny.path / "release" / "lab_1_2" / "lab_1_2.ipynb"
    tiny.hand_in("emil", released.read_text())
    tiny.grade(feedback=True)
    # Entered once more by nbgrader, into a gradebook that says something else; what a person has given stays in both.
    other = Path(shutil.copytree(tiny.path, tmp_path / "other"))
    with sqlite3.connect(other / "gradebook.db") as book:
        book.execute("UPDATE grade SET auto_score = 77, needs_manual_grade = NOT needs_manual_grade")
        book.execute("UPDATE comment SET auto_comment = 'wrong'")
        book.execute("UPDATE submitted_notebook SET late_submission_penalty = 5")
    assert everything(tiny.path) != everything(other)
    enter_as_nbgrader_does(other)
    assert everything(tiny.path) == everything(other)
    assert any("No response." in row for row in everything(tiny.path)["comment c"])
    for path in (tiny.path, other):
        with sqlite3.connect(path / "gradebook.db") as book:
            book.execute("UPDATE grade SET manual_score = 3, extra_credit = 1 WHERE auto_score = 4")
            book.execute("UPDATE comment SET manual_comment = 'well done'")
    tiny.grade(again=True, feedback=True)
    enter_as_nbgrader_does(other)
    assert everything(tiny.path) == everything(other)
    for file in sorted((tiny.path / "autograded").rglob("*.ipynb")):
        page = pages(tiny.path)[str(file.relative_to(tiny.path / "autograded").with_suffix(".html"))]
        theirs = str(BeautifulSoup(page_as_nbgrader_makes_it(tiny.path, file), features="html.parser"))
        # Ours has the title of the notebook, theirs the name of its file.
        assert page == theirs.replace("<title>lab_1_2<", "<title>Tiny<").replace(
            "<h4>lab_1_2 (", "<h4>Tiny ("
        )


def test_what_cannot_be_converted_leaves_zero_and_a_word(
    tiny: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada")
    tiny.submit("ben")
    tiny.grade()
    tiny.submit("ada", 9)
    tiny.submit("ben", 9)
    usual = gradebook_writing.enter

    def fail(url: str, submission: Submission, *rest: Any) -> bool:
        entered = usual(url, submission, *rest)
        if submission.student == "ada":
            raise RuntimeError("no more")
        return entered

    monkeypatch.setattr(gradebook_writing, "enter", fail)
    report = tiny.grade()
    assert tiny.scores("ada") == {TALKER: 0, LISTENER: 0}
    assert tiny.scores("ben")[TALKER] == 9
    assert not (tiny.path / "autograded" / "ada" / "lab_1_2").exists()
    assert len(report.problems) == 1


def test_what_is_entered_for_a_submission_is_one_transaction(
    tiny: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada")

    put = gradebook_writing._put

    def fail(book: Connection, rows: list[dict[str, object]], statement: str) -> None:
        if "INTO comment" in statement:
            raise RuntimeError("in the middle")
        put(book, rows, statement)

    monkeypatch.setattr(gradebook_writing, "_put", fail)
    report = tiny.grade()
    assert "in the middle" in report.problems[0]
    assert everything(tiny.path)["grade g"] == everything(tiny.path)["student"] == []


def test_a_gradebook_that_was_put_back_is_read_anew(tiny: TinyClass) -> None:
    """What SQLAlchemy knows of a gradebook is kept between transactions, but nothing of what is in it."""
    book = tiny.path / "gradebook.db"
    url = ClassDirectory(tiny.path).gradebook_url
    ada = ("ada", "lab_1_2")
    tiny.submit("ada", 4)
    tiny.grade()
    shutil.copy(book, book.with_suffix(".copy"))
    tiny.submit("ada", 9)
    tiny.grade()
    assert read_entries(url)[ada].judged("lab_1_2", TALKER) == 9
    book.with_suffix(".copy").replace(book)
    assert read_entries(url)[ada].judged("lab_1_2", TALKER) == 4


def test_a_notebook_that_was_replaced_while_it_ran_is_not_given_the_old_ones_points(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    tiny.submit("ada", 10)
    fake_engine.before = lambda _: tiny.submit("ada", 1)
    report = tiny.grade()
    assert everything(tiny.path)["grade g"] == []
    assert "was changed while it was graded" in report.problems[0]
    assert "nbgrader.log" not in report.problems[0], "it says nothing of that"
    fake_engine.before = lambda _: None
    tiny.grade()
    assert tiny.scores("ada")[TALKER] == 1


def test_a_timestamp_that_is_a_link_is_none(tiny: TinyClass, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("2026-01-02 05:04:05.000000 UTC")
    tiny.submit("ada").with_name("timestamp.txt").symlink_to(tmp_path / "secret")
    tiny.submit("ben").with_name("timestamp.txt").write_text("yesterday\x00, I think")
    report = tiny.grade(feedback=True)
    assert not re.search("2026", everything(tiny.path)["submitted_assignment s"][0])
    assert "does not contain a time" in report.problems[0]
    assert len(list((tiny.path / "autograded" / "ada").rglob("*.txt"))) == 0


@pytest.mark.parametrize(
    "stamp", ["1970-01-01 00:00:00.000000 UTC", "2999-01-01 00:00:00.000000 UTC", "0001-01-01"]
)
def test_a_time_at_which_nobody_can_have_handed_in_is_refused(tmp_path: Path, stamp: str) -> None:
    (tmp_path / "timestamp.txt").write_text(stamp)
    with pytest.raises(ValueError, match="in the future or before this course existed"):
        handed_in_at(tmp_path)
    (tmp_path / "timestamp.txt").write_text("2026-01-02 05:04:05.000000 UTC")
    assert handed_in_at(tmp_path) == datetime(2026, 1, 2, 5, 4, 5)
