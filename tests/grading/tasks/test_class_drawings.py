"""A class has drawings of its own: recorded once, before any submission runs, and given to the judge with the task."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from tiny_class import COURSE, FakeEngine, TinyClass

from autograder import course
from autograder.execution.verdicts_without_judge import grader_trouble
from autograder.grading import course_version
from autograder.grading.cluster import cluster_dispatcher
from autograder.grading.course_version import CourseFiles
from autograder.grading.running import execution_backends
from autograder.grading.tasks import class_drawings
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.execution.executed_cells import Execution
    from autograder.grading.grading_task import Task

DRAWN = "lab_1_2.talker"
"""The exercise of the tiny class that draws its inputs in these tests."""


class Recorder(FakeEngine):
    """Records the name of a drawing as the drawing, and keeps what each submission was given."""

    def __init__(self) -> None:
        super().__init__()
        self.recorded: list[str] = []
        self.given: dict[str, str] = {}
        self.trouble = ""

    def execute(self, task: Task) -> Execution:
        if not task.records:
            self.given[task.student] = task.drawings[DRAWN]
            return super().execute(task)
        self.recorded.append(task.records)
        execution = super().execute(replace(task, cells=()))
        check = task.cells[1].check
        assert check is not None
        verdicts = {1: grader_trouble(check, self.trouble)}
        evidence = {} if self.trouble else {DRAWN: task.records.encode()}
        return replace(execution, verdicts=verdicts, evidence=evidence, trouble=self.trouble)


@pytest.fixture(autouse=True)
def _talker_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(class_drawings, "_is_drawn", lambda exercise: exercise == DRAWN)


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> Recorder:
    recorder = Recorder()
    monkeypatch.setattr(execution_backends, "execute_all", recorder.execute_all)
    return recorder


def folder(tiny: TinyClass) -> Path:
    return tiny.path / ".autograder" / class_drawings.FOLDER


def test_a_submission_gets_a_drawing_that_is_recorded_before_and_only_once(
    tiny: TinyClass, engine: Recorder
) -> None:
    tiny.submit("ada")
    tiny.grade()
    assert engine.ran == ["the solution", "ada"]
    (name,) = engine.recorded
    assert engine.given == {"ada": name}
    assert name.startswith("drawing ")
    tiny.submit("ben", 9)
    tiny.grade(again=True)
    assert engine.given["ada"] == name
    assert engine.recorded.count(name) == 1


def test_only_the_owner_can_read_a_drawing(tiny: TinyClass, engine: Recorder) -> None:
    tiny.submit("ada")
    tiny.grade()
    (file,) = folder(tiny).iterdir()
    assert engine.recorded[0] in file.read_text()
    assert (folder(tiny).stat().st_mode & 0o777, file.stat().st_mode & 0o777) == (0o700, 0o600)


def test_the_same_answer_meets_the_same_drawing_and_others_meet_others(
    tiny: TinyClass, engine: Recorder
) -> None:
    for number in range(30):
        tiny.submit(f"student{number:02}", number % 10)
    tiny.grade()
    first = dict(engine.given)
    assert 8 <= len(set(first.values())) <= class_drawings.DRAWINGS
    assert len(engine.recorded) == class_drawings.DRAWINGS, "a large class is not read twice"
    tiny.grade(again=True)
    assert engine.given == first
    assert len(engine.recorded) == class_drawings.DRAWINGS


def test_few_submissions_need_few_drawings(tiny: TinyClass, engine: Recorder) -> None:
    for number in range(3):
        tiny.submit(f"student{number}", number)
    tiny.grade()
    assert sorted(engine.recorded) == sorted(set(engine.given.values()))


def test_another_class_has_other_drawings(tiny: TinyClass, engine: Recorder) -> None:
    for number in range(class_drawings.DRAWINGS):
        tiny.submit(f"student{number}", number % 10)
    tiny.grade()
    ours = set(engine.recorded)
    (tiny.path / ".autograder" / "secret").write_text("ab" * 32)
    tiny.grade()
    assert len(engine.recorded) == 2 * class_drawings.DRAWINGS
    assert ours.isdisjoint(engine.recorded[class_drawings.DRAWINGS :])


@pytest.mark.parametrize(
    ("file", "is_recorded_again"),
    cases(__file__, "a_drawing_is_recorded_again_if_what_it_comes_from_has_changed"),
)
def test_a_drawing_is_recorded_again_if_what_it_comes_from_has_changed(
    file: str, is_recorded_again: bool, tiny: TinyClass, engine: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada")
    tiny.grade()
    changed = CourseFiles({**COURSE, file: b"changed"}.items())
    monkeypatch.setattr(course_version, "course_files", lambda: changed)
    tiny.grade()
    assert engine.recorded == engine.recorded[:1] * (1 + is_recorded_again)


def test_on_a_cluster_the_solution_runs_on_the_machine_of_the_class(
    tiny: TinyClass, engine: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = Recorder()
    workers = contextlib.nullcontext(elsewhere.execute_all)
    monkeypatch.setattr(cluster_dispatcher, "on_cluster", lambda *_: workers)
    monkeypatch.setattr(cluster_dispatcher, "check_dask", lambda: None)
    tiny.submit("ada")
    tiny.grade(scheduler="tcp://10.0.0.1:8786")
    assert (engine.given, elsewhere.recorded) == ({}, [])
    assert elsewhere.given == {"ada": engine.recorded[0]}


def test_a_damaged_file_is_recorded_again(tiny: TinyClass, engine: Recorder) -> None:
    tiny.submit("ada")
    tiny.grade()
    (file,) = folder(tiny).iterdir()
    file.write_bytes(file.read_bytes()[:-9])
    tiny.grade(again=True)
    assert len(engine.recorded) == 2


def test_a_drawing_that_cannot_be_recorded_is_a_problem_and_none_is_given(
    tiny: TinyClass, engine: Recorder
) -> None:
    tiny.submit("ada")
    engine.trouble = "it did not do the same twice"
    report = tiny.grade()
    assert [one for one in report.problems if "not recorded" in one] == [
        f"{DRAWN} cannot be checked, because its solution was not recorded: it did not do the same twice"
    ]
    assert engine.given == {"ada": ""}
    engine.trouble = ""
    tiny.grade(again=True)
    assert engine.given["ada"] == engine.recorded[-1]


def test_without_a_usable_master_nothing_is_recorded(
    tiny: TinyClass, engine: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(course, "LAB", "no_such_master.md")
    tiny.submit("ada")
    report = tiny.grade()
    assert "no_such_master.md" in " ".join(report.problems)
    assert (engine.recorded, engine.given) == ([], {"ada": ""})
