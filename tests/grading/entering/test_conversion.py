"""What is written in this process is what nbgrader writes, and fails closed as it does."""

from __future__ import annotations

import json
import re
import shutil
import sqlite3
from datetime import datetime
from typing import TYPE_CHECKING, Any

import pytest
from bs4 import BeautifulSoup
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.classes.timestamps import handed_in_at
from autograder.grading.entering import conversion, gradebook
from autograder.grading.returning import feedback

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning")


def everything(path: Path) -> dict[str, Any]:
    """What the gradebook holds, without the ids that are drawn anew in each."""
    book = sqlite3.connect(path / "gradebook.db")
    found = {}
    for table, columns in {
        "submitted_assignment s": "s.student_id, (SELECT name FROM assignment WHERE id = s.assignment_id),"
        " s.timestamp, s.extension",
        "submitted_notebook sn": "(SELECT name FROM notebook WHERE id = sn.notebook_id), sn.flagged,"
        " sn.late_submission_penalty, (SELECT student_id FROM submitted_assignment WHERE id = sn.assignment_id)",
        "grade g": "(SELECT name || type FROM base_cell WHERE id = g.cell_id), g.auto_score, g.manual_score,"
        " g.extra_credit, g.needs_manual_grade",
        "comment c": "(SELECT name || type FROM base_cell WHERE id = c.cell_id), c.auto_comment, c.manual_comment",
        "student": "id, first_name, last_name",
    }.items():
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


def test_a_new_class_is_converted_here(tiny: TinyClass) -> None:
    config = ClassDirectory(tiny.path).config
    assert conversion.is_usual(config)
    assert feedback.is_usual(config)
    tiny.configure_otherwise()
    config = ClassDirectory(tiny.path).config
    assert not conversion.is_usual(config)
    assert not feedback.is_usual(config)


@pytest.mark.parametrize("penalty", ["none", "zero"])
def test_both_ways_leave_the_same_behind(
    tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path, penalty: str
) -> None:
    with (tiny.path / "nbgrader_config.py").open("a") as config:
        config.write(f"c.LateSubmissionPlugin.penalty_method = {penalty!r}\n")
    with sqlite3.connect(tiny.path / "gradebook.db") as book:
        book.execute("UPDATE assignment SET duedate = '2026-01-02 03:04:05.000000'")
    (tiny.path / "source" / "lab_1_2" / "data.csv").write_text("1,2\n")
    tiny.submit("ada", 10, 4)
    late = tiny.submit("ben", 7, 0).with_name("timestamp.txt")
    late.write_text("2026-01-02 05:04:05.000000 UTC")
    tiny.hand_in("cleo", "not a notebook")
    tiny.submit("dora", "'raise'").with_name("timestamp.txt").write_text("2026-01-01 05:04:05.000000 UTC")
    # A notebook that its student never touched: nbgrader comments "No response." on it.
    released = tiny.path / "release" / "lab_1_2" / "lab_1_2.ipynb"
    tiny.hand_in("emil", released.read_text())
    other = TinyClass(tmp_path / "other")
    shutil.copytree(tiny.path, other.path)
    other.configure_otherwise()
    tiny.grade(feedback=True)
    other.grade(feedback=True)
    # By hand, and once more: what a person entered has to survive both.
    for which in (tiny, other):
        with sqlite3.connect(which.path / "gradebook.db") as book:
            book.execute("UPDATE grade SET manual_score = 3, extra_credit = 1 WHERE auto_score = 4")
            book.execute("UPDATE comment SET manual_comment = 'well done'")
        which.grade(again=True, feedback=True)
    assert everything(tiny.path) == everything(other.path)
    assert notebooks(tiny.path) == notebooks(other.path)
    assert pages(tiny.path) == pages(other.path)
    assert any("No response." in row for row in everything(tiny.path)["comment c"])


def test_what_cannot_be_converted_leaves_zero_and_a_word(
    tiny: TinyClass, fake_engine: FakeEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada")
    tiny.submit("ben")
    tiny.grade()
    tiny.submit("ada", 9)
    tiny.submit("ben", 9)
    usual = gradebook.enter

    def fail(url: str, assignment: str, student: str, *rest: Any) -> bool:
        entered = usual(url, assignment, student, *rest)
        if student == "ada":
            raise RuntimeError("no more")
        return entered

    monkeypatch.setattr(gradebook, "enter", fail)
    report = tiny.grade()
    assert tiny.scores("ada") == {TALKER: 0, LISTENER: 0}
    assert tiny.scores("ben")[TALKER] == 9
    assert not (tiny.path / "autograded" / "ada" / "lab_1_2").exists()
    assert len(report.problems) == 1


def test_what_is_entered_for_a_submission_is_one_transaction(
    tiny: TinyClass, fake_engine: FakeEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada")

    def fail(*_: object) -> None:
        raise RuntimeError("in the middle")

    monkeypatch.setattr(gradebook, "_enter_comments", fail)
    report = tiny.grade()
    assert "in the middle" in report.problems[0]
    assert everything(tiny.path)["grade g"] == everything(tiny.path)["student"] == []


def test_a_gradebook_that_was_put_back_is_read_anew(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    """What SQLAlchemy knows of a gradebook is kept between transactions, but nothing of what is in it."""
    book = tiny.path / "gradebook.db"
    url = ClassDirectory(tiny.path).gradebook_url
    tiny.submit("ada", 4)
    tiny.grade()
    shutil.copy(book, book.with_suffix(".copy"))
    tiny.submit("ada", 9)
    tiny.grade()
    assert gradebook.scores_of_student(url, "lab_1_2", "ada")["lab_1_2"][TALKER] == 9
    book.with_suffix(".copy").replace(book)
    assert gradebook.scores_of_student(url, "lab_1_2", "ada")["lab_1_2"][TALKER] == 4


def test_a_notebook_that_was_replaced_while_it_ran_is_not_given_the_old_ones_points(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    tiny.submit("ada", 10)
    fake_engine.before = lambda _: tiny.submit("ada", 1)
    report = tiny.grade()
    assert everything(tiny.path)["grade g"] == []
    assert "was changed while it was graded" in report.problems[0]
    fake_engine.before = lambda _: None
    tiny.grade()
    assert tiny.scores("ada")[TALKER] == 1


def test_a_timestamp_that_is_a_link_is_none(tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("2026-01-02 05:04:05.000000 UTC")
    tiny.submit("ada").with_name("timestamp.txt").symlink_to(tmp_path / "secret")
    tiny.submit("ben").with_name("timestamp.txt").write_text("yesterday\x00, I think")
    report = tiny.grade(feedback=True)
    assert not re.search("2026", everything(tiny.path)["submitted_assignment s"][0])
    assert "holds no time" in report.problems[0]
    assert len(list((tiny.path / "autograded" / "ada").rglob("*.txt"))) == 0


@pytest.mark.parametrize(
    "stamp", ["1970-01-01 00:00:00.000000 UTC", "2999-01-01 00:00:00.000000 UTC", "0001-01-01"]
)
def test_a_time_at_which_nobody_can_have_handed_in_is_refused(tmp_path: Path, stamp: str) -> None:
    (tmp_path / "timestamp.txt").write_text(stamp)
    with pytest.raises(ValueError, match="nobody can have handed in"):
        handed_in_at(tmp_path)
    (tmp_path / "timestamp.txt").write_text("2026-01-02 05:04:05.000000 UTC")
    assert handed_in_at(tmp_path) == datetime(2026, 1, 2, 5, 4, 5)
