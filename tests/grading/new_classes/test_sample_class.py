"""The whole way with real ROS: the sample class graded by our command."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

import pytest
from nbgrader.api import Gradebook
from tiny_class import QUIET

from autograder import exercises
from autograder.grading.grading_errors import GradingError
from autograder.grading.new_classes import sample_class
from autograder.grading.new_classes.sample_class import SampleNotebook, demo, sample_notebooks
from tests.submissions.odd_notebooks import FIXTURES, odd_notebooks, text_of
from tests.tiers import asked_for

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from autograder.grading.reporting.grade_report import GradeReport

SAMPLES = (*odd_notebooks(), *(one for one in sample_notebooks(sample_class.DATA) if one.expected))
"""Every kind of submission, and the mistakes of the class of ``./course demo``."""


@pytest.fixture(scope="module")
def handed_in(request: pytest.FixtureRequest) -> tuple[SampleNotebook, ...]:
    """The samples that this session asks for."""
    asked = asked_for(request, "notebook")
    return tuple(notebook for notebook in SAMPLES if notebook in asked)


@pytest.fixture(scope="module")
def graded(
    handed_in: tuple[SampleNotebook, ...], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[GradeReport]:
    """The class of these samples, graded as ``./course demo`` does it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sample_class, "DATA", FIXTURES)
        patch.setattr(sample_class, "sample_notebooks", lambda _: handed_in)
        patch.setattr(sample_class, "sample_text", text_of)
        yield demo(tmp_path_factory.mktemp("demo") / "demo-class", console=QUIET)


def test_the_data_names_students_and_exercises_once() -> None:
    notebooks = odd_notebooks()
    assert len({(notebook.student, notebook.assignment) for notebook in notebooks}) == len(notebooks)
    assert len({notebook.student for notebook in notebooks}) >= 12
    for notebook in notebooks:
        assert set(notebook.expected) == {
            e for e in exercises.all_ids() if e.startswith(f"{notebook.assignment}.")
        }


def test_the_class_of_the_demo_is_like_a_class() -> None:
    data = sample_class.sample_data(sample_class.DATA)
    notebooks = sample_notebooks(sample_class.DATA)
    assert len(data.students) >= 20
    assert all(" " in name for name in data.students.values())
    assert {one.student for one in notebooks} == set(data.students)
    assert len(data.assignments) == 3
    right = sum(not one.expected for one in notebooks)
    assert 0.6 < right / len(notebooks) < 0.9
    assert data.shown in {(one.student, one.assignment) for one in notebooks if one.expected}


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("notebook", SAMPLES, ids=lambda n: f"{n.student}-{n.assignment}")
def test_every_sample_earns_what_it_must(
    handed_in: tuple[SampleNotebook, ...], graded: GradeReport, notebook: SampleNotebook
) -> None:
    rows = {row.exercise: row for row in graded.rows if row.student == notebook.student}
    got = {exercise: (rows[exercise].score, rows[exercise].diagnosis) for exercise in notebook.expected}
    assert got == notebook.expected, notebook.about


@pytest.mark.ros
@pytest.mark.slow
def test_gradebook_csv_and_feedback_say_the_same(
    graded: GradeReport, handed_in: tuple[SampleNotebook, ...]
) -> None:
    with (graded.path / "grades.csv").open(encoding="utf-8-sig") as file:
        judged = [row for row in csv.DictReader(file) if row["score"]]
    in_csv = {(row["student"], row["exercise"]): float(row["score"]) for row in judged}
    with Gradebook(f"sqlite:///{graded.gradebook}") as book:
        for notebook in handed_in:
            name = notebook.assignment
            for exercise, (score, _) in notebook.expected.items():
                grade = book.find_grade(exercises.grade_id(exercise), name, name, notebook.student)
                assert grade.auto_score == in_csv[notebook.student, exercise] == score
            of_notebook = [
                key for key in in_csv if key[0] == notebook.student and key[1].startswith(f"{name}.")
            ]
            total = sum(in_csv[key] for key in of_notebook)
            page = (graded.feedback / notebook.student / name / f"{name}.html").read_text()
            assert f"(Score: {total:.1f} /" in page


@pytest.mark.ros
@pytest.mark.slow
def test_a_second_run_takes_what_is_known(graded: GradeReport) -> None:
    again = demo(graded.path, console=QUIET)
    assert (again.executed, again.written) == (0, 0)
    assert again.rows == graded.rows


def test_a_class_of_ones_own_is_not_taken_for_the_sample(tmp_path: Path) -> None:
    (tmp_path / "nbgrader_config.py").write_text("c = get_config()\n")
    with pytest.raises(GradingError, match="a class that is not the sample"):
        demo(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["nbgrader_config.py"]
