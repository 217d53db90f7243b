"""Only what may change a result executes a notebook again, and the run says which part of the key changed."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING

import nbformat
import pytest
from tiny_class import COURSE, LISTENER, TALKER, FakeEngine, TinyClass, shown

from autograder.grading import course_version
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.course_version import CourseFiles
from autograder.grading.reporting.grade_report import report_json
from autograder.grading.tasks import graded_notebooks
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from autograder.execution.executed_cells import Execution
    from autograder.grading.grading_task import Task
    from autograder.grading.reporting.grade_report import GradeReport

_, CARDS, EXERCISE, _ = COURSE

pytestmark = pytest.mark.usefixtures("fake_engine")


@pytest.fixture
def course(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Change files of the course."""

    def change(*names: str) -> None:
        files = COURSE | dict.fromkeys(names, b"changed")
        monkeypatch.setattr(course_version, "course_files", lambda: CourseFiles(files.items()))

    return change


def resaved(path: Path, *, source: str = "") -> None:
    """Save a notebook with other outputs, or with other text in a text cell."""
    notebook = nbformat.read(path, as_version=4)
    notebook.metadata["saved"] = "again"
    for cell in notebook.cells:
        if source and cell.cell_type == "markdown" and "Between" in cell.source:
            cell.source = source
    path.write_text(nbformat.writes(notebook))


def store_of(tiny: TinyClass) -> ClassStore:
    return ClassStore(ClassDirectory(tiny.path))


@pytest.mark.parametrize(("files", "why"), cases(__file__, "a_change_of_the_course"))
def test_a_change_of_the_course(
    tiny: TinyClass, course: Callable[..., None], files: tuple[str, ...], why: dict[str, int]
) -> None:
    tiny.submit("ada", 4, 7)
    tiny.submit("ben")
    assert tiny.grade().run_again == {}, "no notebook was executed before"
    course(*files)
    report = tiny.grade()
    assert (report.executed, report.run_again) == (sum(why.values()), why)
    assert json.loads(report_json(report))["run_again"] == why
    said = [line for line in shown(report).splitlines() if line.startswith("run again")]
    assert said == [f"run again    2 notebooks: {words}" for words in why]
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}
    assert tiny.grade().executed == 0


def test_points_that_move_without_a_new_submission_are_listed(
    tiny: TinyClass, fake_engine: FakeEngine, course: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    fake_engine.evidence = {"lab_1_2.talker": b"seen"}
    tiny.submit("ada", 4, 7)
    tiny.submit("ben", 4, 7)
    assert tiny.grade().moved == ()
    course(EXERCISE)
    tiny.submit("ben", 10, 10)
    execute = fake_engine.execute

    def stricter(task: Task) -> Execution:
        execution = execute(task)
        lower = {index: replace(one, score=one.score - 1) for index, one in execution.verdicts.items()}
        return replace(execution, verdicts=lower)

    monkeypatch.setattr(fake_engine, "execute", stricter)
    tiny.grade(dry_run=True)
    for _ in range(2):  # the question stays until it is answered
        report = tiny.grade()
        first, second = first_words(report, "fell")
        assert "lab_1_2.talker, on the same files (the exercise changed): ada 4 → 3." in first
        assert "lab_1_2.listener" in second
        assert (report.moved, report.exit_code) == ((), 2)
        assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}
    assert write_appeal_of("ada", tiny)
    assert tiny.grade(lower="no").fallen == ()
    assert tiny.grade(again=True, students=["ada"]).executed == 1
    report = tiny.grade(lower="yes")
    assert first_words(report, "moved") == [
        "moved        ada  lab_1_2.talker  4 → 3",
        "moved        ada  lab_1_2.listener  7 → 6",
    ]
    assert len(json.loads(report_json(report))["moved"]) == 2
    assert tiny.grade().fallen == ()
    assert tiny.scores("ada") == {TALKER: 3, LISTENER: 6}


def first_words(report: GradeReport, word: str) -> list[str]:
    """The lines of a report that begin with this word; they stand above everything else."""
    lines = shown(report, 500).splitlines()
    found = [line for line in lines if line.startswith(word)]
    assert lines[: len(found)] == found
    return found


def write_appeal_of(student: str, klass: TinyClass) -> bool:
    """True if the evidence of the points that count is there."""
    with store_of(klass) as store:
        kept, entered = store.evidence(student, "lab_1_2.talker"), store.entered()
    return bool(kept and entered[student, "lab_1_2"].tasks["lab_1_2"] == kept.task)


def test_a_newer_submission_that_is_worse_has_a_line(tiny: TinyClass) -> None:
    tiny.submit("ada", 4, 7)
    tiny.grade()
    tiny.submit("ada", 4, 2)
    assert any("ada/lab_1_2: the newer files have 6 points" in one for one in tiny.grade().notices)
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 2}


def test_a_corrected_sentence_on_a_card_makes_pages_again_and_executes_nothing(
    tiny: TinyClass, course: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada", 4, 7)
    tiny.grade(feedback=True)
    page = tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html"
    assert "A corrected sentence." not in page.read_text()
    monkeypatch.setattr(graded_notebooks, "card_bundle", lambda _: {"text/plain": "A corrected sentence."})
    course(CARDS)
    report = tiny.grade(feedback=True)
    assert (report.executed, report.reused, report.written) == (0, 1, 1)
    assert "A corrected sentence." in page.read_text()
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}
    assert tiny.grade(feedback=True).written == 0


def test_a_change_of_the_class(tiny: TinyClass) -> None:
    file = tiny.submit("ada", 4, 7)
    tiny.submit("ben", "'die'")
    source = tiny.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    tiny.grade()
    resaved(file)
    assert tiny.grade().run_again == {"its result was not kept": 1}, "the judge had failed for ben"
    resaved(source)
    assert tiny.grade(students=["ada"]).run_again == {}
    tiny.submit("ada", 10, 7)
    assert tiny.grade(students=["ada"]).run_again == {"the submission changed": 1}
    resaved(source, source="Between both.")
    assert tiny.grade(students=["ada"]).run_again == {"the released notebook changed": 1}
    tiny.configure("c.WireExecute.memory_bytes = 4_000_000_000")
    assert tiny.grade(students=["ada"]).run_again == {"the settings of the class changed": 1}
    assert tiny.grade(students=["ada"], again=True).run_again == {"--again was given": 1}
    assert tiny.scores("ada") == {TALKER: 10, LISTENER: 7}
