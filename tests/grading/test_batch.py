"""Grading a class of which nothing is executed: what is asked here is what ends up in the gradebook."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING, Any

import pytest
from nbgrader.api import Gradebook
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass

from autograder.grading.classes import gradebook_writing
from autograder.grading.classes.class_directory import ClassDirectory, Submission
from autograder.grading.classes.gradebook_writing import NotebookEntry
from autograder.grading.grading_errors import GradingError, MasterUnusable, NotAClass
from autograder.grading.new_classes.new_class import release
from autograder.safe_files import fresh_folder

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.grading.reporting.grade_report import GradeReport
    from autograder.grading.table.rows import Row

pytestmark = pytest.mark.usefixtures("fake_engine")


def states(report: GradeReport, student: str) -> list[str]:
    return [row.state for row in report.rows if row.student == student]


def row(report: GradeReport, student: str, exercise: str = "lab_1_2.talker") -> Row:
    return next(row for row in report.rows if (row.student, row.exercise) == (student, exercise))


def test_a_point_value_changed_by_the_instructor_scales_the_judges_score(tiny: TinyClass) -> None:
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    source.write_text(source.read_text().replace('"points": 10', '"points": 3'))
    release(ClassDirectory(tiny.path))
    tiny.submit("ada", 5, 10)
    tiny.grade()
    assert tiny.scores("ada") == {TALKER: 1.5, LISTENER: 3}


def test_a_copy_of_a_class_is_graded_elsewhere_and_nothing_is_run_again(
    tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path
) -> None:
    tiny.submit("ada", 10, 4)
    tiny.grade()
    copied = TinyClass(shutil.copytree(tiny.path, tmp_path / "other-computer" / "robotics"))
    shutil.rmtree(tiny.path)
    fake_engine.ran.clear()
    report = copied.grade()
    assert fake_engine.ran == []
    assert (report.executed, row(report, "ada", "lab_1_2.listener").score) == (0, 4)
    assert copied.scores("ada") == {TALKER: 10, LISTENER: 4}


def test_what_a_killed_batch_left_goes_also_where_nothing_is_executed(tiny: TinyClass) -> None:
    tiny.submit("ada", 10, 10)
    tiny.grade()
    left = fresh_folder(ClassDirectory(tiny.path).scratch_prefix)
    (left / "lab_1_2.ipynb").write_text("{}")
    report = tiny.grade()
    assert report.executed == 0
    assert not left.exists()


def test_only_the_named_students_and_assignments(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    tiny.submit("ben")
    report = tiny.grade(students=["ben"], assignments=["lab_1_2"])
    assert fake_engine.ran == ["ben"]
    assert {row.student for row in report.rows} == {"ben"}
    assert "ada,lab_1_2,lab_1_2.talker,,10,not_graded" in (tiny.path / "grades.csv").read_text()
    tiny.grade()
    tiny.submit("ben", 2)
    tiny.grade(students=["ben"])
    assert "ada,lab_1_2,lab_1_2.talker,10,10,passed" in (tiny.path / "grades.csv").read_text()
    with pytest.raises(GradingError, match="No student is named eve"):
        tiny.grade(students=["eve"])
    with pytest.raises(GradingError, match="No assignment is named big"):
        tiny.grade(assignments=["big"])


# -- fail closed
# ------------------------------------------------------------------------------------------------


def test_grades_are_taken_back_before_the_first_notebook_runs(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    for student in ("ada", "ben"):
        tiny.submit(student)
    tiny.grade(feedback=True)
    for student in ("ada", "ben"):
        tiny.submit(student, 2)

    def stop(_: object) -> None:
        assert tiny.scores("ada") == tiny.scores("ben") == {TALKER: 0, LISTENER: 0}
        assert not (tiny.path / "autograded" / "ada" / "lab_1_2").exists()
        assert not (tiny.path / "feedback" / "ben" / "lab_1_2").exists()
        raise KeyboardInterrupt

    fake_engine.before = stop
    with pytest.raises(KeyboardInterrupt):
        tiny.grade()
    assert tiny.scores("ben") == {TALKER: 0, LISTENER: 0}


def test_a_gradebook_that_says_something_else_afterwards_is_not_believed(
    tiny: TinyClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = gradebook_writing.enter

    def generous(url: str, submission: Submission, notebooks: Any, at: Any) -> bool:
        ten = {name: NotebookEntry({TALKER: 10}, {}) for name in notebooks}
        return usual(url, submission, ten, at)

    monkeypatch.setattr(gradebook_writing, "enter", generous)
    tiny.submit("ada", 4)
    report = tiny.grade()
    assert tiny.scores("ada")[TALKER] == 0
    assert "does not have 4 points" in report.problems[0]


def test_a_score_changed_behind_our_back_is_put_right(tiny: TinyClass) -> None:
    tiny.submit("ada", 4)
    tiny.grade()
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        book.find_grade(TALKER, "lab_1_2", "lab_1_2", "ada").auto_score = 10
        book.db.commit()
    report = tiny.grade()
    assert tiny.scores("ada")[TALKER] == 4
    assert report.executed == 0


# -- what students hand in
# ----------------------------------------------------------------------------------------


def test_a_notebook_under_another_name_is_named_in_the_reason(tiny: TinyClass) -> None:
    path = tiny.submit("ada")
    path.rename(path.with_name("homework.ipynb"))
    report = tiny.grade(feedback=True)
    assert "homework.ipynb" in row(report, "ada").reason
    assert tiny.scores("ada")[TALKER] == 0
    assert (tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html").exists()


def test_names_that_people_have_are_fine(tiny: TinyClass) -> None:
    names = ["ada.lovelace", "o'neill", "Ада", "s-1234_5", "a b", "x@uni.example"]
    for name in names:
        tiny.submit(name)
    assert tiny.grade(feedback=True).exit_code == 0
    for name in names:
        assert tiny.scores(name)[TALKER] == 10
        assert (tiny.path / "feedback" / name / "lab_1_2" / "lab_1_2.html").exists()


def test_an_assignment_that_does_not_exist_is_refused(tiny: TinyClass) -> None:
    (tiny.path / "submitted" / "ada" / "tyni").mkdir(parents=True)
    report = tiny.grade()
    assert "the class's assignments: lab_1_2" in report.refused[0].reason


def test_plain_files_and_hidden_ones_are_nobodys_work(tiny: TinyClass) -> None:
    tiny.submit("ada")
    (tiny.path / "submitted" / "README.txt").write_text("hello")
    (tiny.path / "submitted" / ".DS_Store").write_text("")
    assert tiny.grade().exit_code == 0


def test_an_empty_class_is_a_report_without_rows(tiny: TinyClass) -> None:
    report = tiny.grade()
    assert report.rows == ()
    assert report.exit_code == 0


# -- the class
# ----------------------------------------------------------------------------------------------------


def test_a_folder_that_is_no_class_says_what_to_do(tmp_path: Path) -> None:
    from autograder.grading.batch import grade

    for path in (tmp_path / "missing", tmp_path):
        with pytest.raises(NotAClass, match=r"\./course new-class"):
            grade(path)


def test_two_classes_at_once_are_both_right(tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path) -> None:
    import shutil

    other = TinyClass(tmp_path / "other")
    shutil.copytree(tiny.path, other.path)
    tiny.submit("ada", 3)
    other.submit("ada", 7)

    def both(task: object) -> None:
        fake_engine.before = lambda _: None
        other.grade()

    fake_engine.before = both
    tiny.grade()
    assert (tiny.scores("ada")[TALKER], other.scores("ada")[TALKER]) == (3, 7)


@pytest.mark.parametrize(
    ("old", "new", "error", "words"),
    [
        ("", "{", MasterUnusable, "is not a notebook"),
        ("### END SOLUTION", "", MasterUnusable, "cannot be prepared with nbgrader's steps"),
        (TALKER, "lab_9_9-talker", MasterUnusable, "lab_9_9-talker"),
        ('"points": 10', '"points": 3', GradingError, "nbgrader generate_assignment lab_1_2 --force"),
    ],
    ids=["no notebook", "nbgrader refuses it", "no such exercise", "not in the gradebook"],
)
def test_a_source_that_cannot_be_used_stops_the_run(
    tiny: TinyClass, old: str, new: str, error: type[GradingError], words: str
) -> None:
    tiny.submit("ada")
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    source.write_text(source.read_text().replace(old, new) if old else new)
    with pytest.raises(error, match=words):
        tiny.grade()


def test_a_config_that_does_not_grade_on_the_wire_is_refused(tiny: TinyClass) -> None:
    (tiny.path / "nbgrader_config.py").write_text("c = get_config()\n")
    with pytest.raises(GradingError, match="does not use the judge for grading"):
        tiny.grade()
    (tiny.path / "nbgrader_config.py").write_text("c = \n")
    with pytest.raises(GradingError, match="cannot be read: SyntaxError"):
        tiny.grade()


# -- what comes out
# -------------------------------------------------------------------------------------------------


def test_the_secret_is_in_nothing_that_is_handed_out(tiny: TinyClass) -> None:
    secret = (tiny.path / ".autograder" / "secret").read_text()
    assert (tiny.path / ".autograder" / "secret").stat().st_mode & 0o077 == 0
    for path in (tiny.path / "release").rglob("*"):
        assert path.is_dir() or secret not in path.read_text()
