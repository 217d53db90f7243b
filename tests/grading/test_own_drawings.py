"""A class with drawings of its own: what knows the hand-out by heart has no points in it."""

from __future__ import annotations

import json
from random import Random
from typing import TYPE_CHECKING, Any
from zipfile import ZipFile

import nbformat
import pytest
from tiny_class import QUIET, write_master

from autograder import course, exercises
from autograder.appeals import appeal_file
from autograder.appeals.replaying import replay
from autograder.grading.batch import grade
from autograder.grading.new_classes.new_class import new_class
from autograder.grading.reporting.appeal_writing import write_appeal
from autograder.judge import evidence_files
from autograder.kit.oracle.same_as_solution import To
from autograder.masters.reference_solutions import reference_source
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.ros, pytest.mark.slow]

NODE, FUNCTION = "lab_2_0.bridge", "project_2.agent"
MASTER = cases(__file__, "MASTER")
SUBJECTS = {NODE: "Bridge", FUNCTION: "decisions"}
NODE_BY_HEART = cases(__file__, "NODE_BY_HEART")
FUNCTION_BY_HEART = cases(__file__, "FUNCTION_BY_HEART")


def by_heart(exercise_id: str, code: str) -> str:
    """Return an answer made from what each hand-out has: the practice inputs, and what is right for them."""
    recipe = exercises.get(exercise_id).scenario.__self__  # type: ignore[attr-defined]
    table = []
    for number, part in enumerate(evidence_files.load_reference(exercise_id).parts):
        first = next(iter(recipe._gives(Random(f"{exercise_id} {number}"))))
        given = first.value["ranges"][0] if isinstance(first, To) else first[0]
        rows = [event.data["values"] for event in part.of("noted") if "without" not in event.data["given"]]
        table.append((given, [row[-1] if exercise_id == NODE else row[0][0] for row in rows]))
    return f"TABLE = {table!r}\n{code}"


def solution(exercise_id: str) -> str:
    """Return the code of the reference solution."""
    return reference_source(exercises.path(exercise_id).with_name(course.LAB), exercise_id).source


class RealClass:
    """A class that the judge itself grades."""

    def __init__(self, folder: Path) -> None:
        for exercise, subject in SUBJECTS.items():
            lab = exercise.partition(".")[0]
            write_master(folder / "course", lab, MASTER.format(exercise=exercise, subject=subject))
        self.path = folder / "class"
        new_class(self.path, folder / "course", timezone="UTC")

    def submit(self, student: str, node: str, function: str) -> None:
        for (exercise, subject), answer in zip(SUBJECTS.items(), (node, function), strict=True):
            lab = exercise.partition(".")[0]
            notebook: Any = nbformat.read(self.path / "release" / lab / f"{lab}.ipynb", as_version=4)
            for cell in notebook.cells:
                if cell.metadata.get("nbgrader", {}).get("grade_id") == subject:
                    cell.source = answer
            to = self.path / "submitted" / student / lab / f"{lab}.ipynb"
            to.parent.mkdir(parents=True)
            nbformat.write(notebook, to)

    def grade(self, **options: Any) -> dict[tuple[str, str], tuple[float, str]]:
        """Return the points and the diagnosis of each student and exercise."""
        report = grade(self.path, feedback=False, console=QUIET, jobs=2, **options)
        assert not report.problems
        return {(row.student, row.exercise): (row.score, row.diagnosis) for row in report.rows}

    def drawings(self) -> dict[str, int]:
        """Return when each drawing was recorded."""
        folder = self.path / ".autograder" / "drawings"
        return {file.name: file.stat().st_mtime_ns for file in folder.iterdir()}

    def appeal(self, student: str, exercise_id: str) -> Path:
        return write_appeal(self.path, student, exercise_id)


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> RealClass:
    made = RealClass(tmp_path_factory.mktemp("real"))
    made.submit("honest", solution(NODE), solution(FUNCTION))
    made.submit("heart", by_heart(NODE, NODE_BY_HEART), by_heart(FUNCTION, FUNCTION_BY_HEART))
    swapped = solution(NODE).replace("linear.x, twist.angular.z", "angular.z, twist.linear.x")
    made.submit("swapped", swapped, "def decisions(observations):\n    return []")
    return made


@pytest.fixture(scope="module")
def graded(real: RealClass) -> dict[tuple[str, str], tuple[float, str]]:
    return real.grade()


def test_what_knows_the_hand_out_by_heart_has_no_points(
    graded: dict[tuple[str, str], tuple[float, str]],
) -> None:
    assert [graded["honest", exercise] for exercise in (NODE, FUNCTION)] == [(10, ""), (10, "")]
    # The node keeps the rate that the task asks for, which is half of the points and depends on no input.
    assert graded["heart", NODE][0] == 5
    assert graded["heart", FUNCTION][0] == 0


def test_a_recorded_wrong_answer_is_named_although_it_was_recorded_with_practice_drawings(
    graded: dict[tuple[str, str], tuple[float, str]],
) -> None:
    assert graded["swapped", NODE][1] == "numbers_swapped"


def test_the_same_submission_meets_the_same_drawing_again_and_nothing_is_recorded(
    real: RealClass, graded: dict[tuple[str, str], tuple[float, str]]
) -> None:
    recorded = real.drawings()
    given = drawing_in(real.appeal("honest", NODE))
    assert real.grade(again=True, students=["honest"]).items() <= graded.items()
    assert drawing_in(real.appeal("honest", NODE)) == given
    assert real.drawings() == recorded


@pytest.mark.parametrize("student", ["honest", "heart", "swapped"])
@pytest.mark.parametrize("exercise_id", [NODE, FUNCTION])
@pytest.mark.usefixtures("graded")
def test_an_appeal_has_the_drawing_and_is_judged_with_it(
    student: str, exercise_id: str, real: RealClass
) -> None:
    file = real.appeal(student, exercise_id)
    seen = appeal_file.read(file).seen
    again = replay(seen)
    assert (again.differences, again.notes) == ([], [])
    with ZipFile(file) as whole:
        expected = evidence_files.parse_reference(json.loads(whole.read("expected.json")))
    assert [part.name for part in expected.parts] == [seen.looks[-1].parts[0].name]


def drawing_in(appeal: Path) -> str:
    """Return the name of the drawing that the subject of an appeal was given."""
    return appeal_file.read(appeal).seen.looks[-1].parts[0].name
