"""Plain nbgrader and ``./course grade`` are two ways to one engine: the same points by both."""

from __future__ import annotations

import errno
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import nbformat
import pytest
from click.testing import CliRunner
from nbgrader.api import Gradebook
from nbgrader.converters import Autograde, GenerateFeedback, NbGraderException
from nbgrader.coursedir import CourseDirectory
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass

from autograder.cli import cli
from autograder.grading.class_store import ClassStore
from autograder.grading.classes import gradebook_writing
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.classes.gradebook_reading import read_entries
from autograder.grading.grading_errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.usefixtures("fake_engine")


def converted(tiny: TinyClass, kind: Any, *, force: bool = False, **chosen: str) -> None:
    """What a command of nbgrader's and a button of formgrader's do with a lab, or with what is chosen of it."""
    config = ClassDirectory(tiny.path).config
    course = CourseDirectory(config=config)
    for name, value in {"assignment_id": "lab_1_2", **chosen}.items():
        setattr(course, name, value)
    converter = kind(coursedir=course, config=config)
    converter.force = force
    converter.start()


def nbgrader_autograde(tiny: TinyClass, *, force: bool = False, **chosen: str) -> None:
    converted(tiny, Autograde, force=force, **chosen)


def nbgrader_generate_feedback(tiny: TinyClass) -> None:
    converted(tiny, GenerateFeedback, force=True)


def hand_in_all_kinds(tiny: TinyClass) -> list[str]:
    tiny.submit("full", 10, 10)
    tiny.submit("partly", 4, 7)
    tiny.submit("crashed", "1/0", 10)
    tiny.submit("judge-died", "'die'", 10)
    tiny.hand_in("not-json", "hello")
    untouched = tiny.released()
    tiny.hand_in("empty", untouched)
    without_check = tiny.released()
    without_check.cells = [
        c for c in without_check.cells if c.metadata.get("nbgrader", {}).get("grade_id") != TALKER
    ]
    tiny.hand_in("deleted-check", without_check)
    doubled = nbformat.read(tiny.submit("doubled", 9, 9), as_version=4)
    doubled.cells += [cell.copy() for cell in doubled.cells]
    tiny.hand_in("doubled", doubled)
    skipping = nbformat.read(tiny.submit("skipping", 0, 0), as_version=4)
    for cell in skipping.cells:
        cell.metadata["tags"] = ["skip-execution"]
        if cell.metadata.get("nbgrader", {}).get("grade"):
            cell.outputs = [
                nbformat.v4.new_output("execute_result", data={"text/plain": "10.0"}, execution_count=1)
            ]
            cell.metadata["nbgrader"]["points"] = 1000
    tiny.hand_in("skipping", skipping)
    return sorted(path.name for path in (tiny.path / "submitted").iterdir())


def test_both_ways_give_the_same_points(tiny: TinyClass, tmp_path: Path) -> None:
    students = hand_in_all_kinds(tiny)
    other = TinyClass(tmp_path / "other")
    shutil.copytree(tiny.path, other.path)
    tiny.grade()
    with pytest.raises(NbGraderException, match="judge-died/lab_1_2/lab_1_2 could not be checked"):
        nbgrader_autograde(other)
    ours = {student: tiny.scores(student) for student in students}
    assert {student: other.scores(student) for student in students} == ours
    assert ours["partly"] == {TALKER: 4, LISTENER: 7}
    assert ours["skipping"] == ours["not-json"] == {TALKER: 0, LISTENER: 0}
    assert ours["doubled"] == {TALKER: 9, LISTENER: 9}


def test_plain_nbgrader_takes_a_known_result_and_leaves_one(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 3)
    nbgrader_autograde(tiny)
    assert fake_engine.ran == ["ada"]
    tiny.grade()
    nbgrader_autograde(tiny, force=True)
    assert fake_engine.ran == ["ada"]
    assert tiny.scores("ada")[TALKER] == 3


@pytest.mark.parametrize("where", ["preparing", "executing", "saving"])
def test_plain_nbgrader_leaves_no_earlier_score_when_it_fails(
    tiny: TinyClass, fake_engine: FakeEngine, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    path = tiny.submit("ada", 10)
    nbgrader_autograde(tiny)
    assert tiny.scores("ada")[TALKER] == 10
    tiny.submit("ada", 9)

    def fail(*_: object, **__: object) -> None:
        raise RuntimeError("no more")

    if where == "preparing":
        (path.parent / "timestamp.txt").write_text("yesterday")
    elif where == "executing":
        monkeypatch.setattr(fake_engine, "execute", fail)
    else:
        monkeypatch.setattr(gradebook_writing, "enter", fail)
    with pytest.raises(RuntimeError if where == "executing" else NbGraderException):
        nbgrader_autograde(tiny, force=True)
    assert tiny.scores("ada") == {TALKER: 0, LISTENER: 0}
    assert not (tiny.path / "autograded" / "ada" / "lab_1_2").exists()


def test_files_of_the_assignment_are_there_and_cannot_be_replaced(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    (tiny.path / "source" / "lab_1_2" / "map.txt").write_text("the real one")
    path = tiny.submit("eve")
    (path.parent / "map.txt").write_text("forged")
    seen: list[bytes] = []
    fake_engine.before = lambda task: seen.append(task.files["map.txt"])
    tiny.grade()
    assert seen == [b"the real one"]
    beside = tiny.path / "autograded" / "eve" / "lab_1_2" / "map.txt"
    assert (beside.read_text(), beside.stat().st_mode & 0o777) == ("the real one", 0o444)


def test_without_our_commands_nothing_is_executed(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    """Else a submission's own metadata would be believed."""
    config = tiny.path / "nbgrader_config.py"
    config.write_text(config.read_text().replace("c.Autograde.exporter_class", "unused"))
    tiny.submit("eve")
    with pytest.raises(NbGraderException):
        nbgrader_autograde(tiny)
    assert fake_engine.ran == []


def test_a_result_that_cannot_be_kept_is_no_result(tiny: TinyClass, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(ClassStore, "keep", full)
    tiny.submit("ada")
    with pytest.raises(NbGraderException):
        nbgrader_autograde(tiny)
    assert read_entries(ClassDirectory(tiny.path).gradebook_url) == {}


def test_a_single_notebook_of_a_submission_is_refused(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    with pytest.raises(NbGraderException, match="leave out --notebook"):
        nbgrader_autograde(tiny, notebook_id="lab_1_2")
    assert fake_engine.ran == []


def test_one_student_of_plain_nbgrader_is_graded_alone(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    """As formgrader's button asks for it; a folder that is refused is named with the reason."""
    tiny.submit("ada", 3)
    tiny.submit("ben", 5)
    (tiny.path / "submitted" / "eve").symlink_to(tiny.path / "submitted" / "ada")
    nbgrader_autograde(tiny, student_id="ben")
    with pytest.raises(NbGraderException, match=r"eve.*: the path is a link; replace the link by the folder"):
        nbgrader_autograde(tiny, student_id="eve")
    assert fake_engine.ran == ["ben"]


@pytest.mark.parametrize("command", ["autograde", "generate_feedback"])
def test_a_command_of_plain_nbgrader_ends_with_the_exit_code_of_ours(tiny: TinyClass, command: str) -> None:
    tiny.submit("ada", 3)
    (tiny.path / "submitted" / "eve").symlink_to(tiny.path / "submitted" / "ada")
    assert CliRunner().invoke(cli, ["grade", str(tiny.path)]).exit_code == 2
    if command == "generate_feedback":  # nbgrader takes what lies in autograded
        shutil.copytree(tiny.path / "autograded" / "ada", tiny.path / "autograded" / "a*")
    done = subprocess.run(
        [sys.executable, "-m", "nbgrader", command, "lab_1_2", "--force"],
        cwd=tiny.path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    reason = (
        "the path is a link; replace the link by the folder"
        if command == "autograde"
        else "rename the folder"
    )
    assert reason in done.stderr


def test_pages_of_plain_nbgrader_follow_what_a_person_has_given(tiny: TinyClass) -> None:
    tiny.submit("ada", 3, 4)
    nbgrader_autograde(tiny)
    nbgrader_generate_feedback(tiny)
    page = tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html"
    assert "(Score: 7.0 / 20.0)" in page.read_text()
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        book.find_grade(TALKER, "lab_1_2", "lab_1_2", "ada").manual_score = 9
        book.db.commit()
    nbgrader_generate_feedback(tiny)
    assert "(Score: 13.0 / 20.0)" in page.read_text()


def test_an_assignment_in_the_making_holds_up_no_other(tiny: TinyClass) -> None:
    """Its source is there already, and the gradebook does not know it yet."""
    shutil.copytree(tiny.path / "source" / "lab_1_2", tiny.path / "source" / "next_week")
    (tiny.path / "source" / "next_week" / "lab_1_2.ipynb").rename(
        tiny.path / "source" / "next_week" / "next_week.ipynb"
    )
    tiny.submit("ada", 3)
    with pytest.raises(GradingError, match="does not contain next_week"):
        tiny.grade()
    nbgrader_autograde(tiny)
    assert tiny.scores("ada")[TALKER] == 3
