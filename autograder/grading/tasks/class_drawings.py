"""The drawings of a class: for each exercise that draws its inputs, the solution in inputs that no hand-out contains.

The seeds come from the class secret. A drawing is recorded when a submission first needs it, on this machine, in a box,
before any submission runs. It stays in the class's state folder. The same submission always gets the same drawing.
"""

from __future__ import annotations

import functools
import hashlib
import hmac
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from autograder import course, exercises
from autograder.execution.executed_cells import Cell, CellCheck
from autograder.grading import course_version
from autograder.grading.course_version import JUDGE, SHARED
from autograder.grading.grading_task import Task
from autograder.kit.oracle.same_as_solution import DRAWING
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from autograder.execution.executed_cells import Execution
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.masters.reference_solutions import ReferenceSolution

FOLDER = "drawings"
"""The name of the folder in the class's state folder. No box sees this folder."""
DRAWINGS = 16
"""The number of drawings of an exercise in a class."""


class Drawing(NamedTuple):
    """One of the drawings of an exercise in a class; ``number`` is less than :data:`DRAWINGS`."""

    exercise: str
    number: int


class KeptDrawing(msgspec.Struct, frozen=True):
    """The content of a file.

    Attributes:
        made_from: The hash of everything from which the drawing was recorded.
        recorded: The recording, as JSON.
    """

    made_from: str
    recorded: str


class ClassDrawings:
    """The recorded drawings of one class."""

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def of(self, task: Task) -> Mapping[str, str]:
        """Return the recording of the drawing that a task gets, for each of its exercises that draws its inputs.

        A recording that does not exist is an empty text.
        """
        return {one.exercise: self._read(one) for one in drawings_of(task)}

    def missing(self, drawings: Iterable[Drawing]) -> list[Task]:
        """Return a task for each of these drawings that is not recorded. The task executes the solution.

        Raises:
            MasterError: The master of an exercise cannot be used.
        """
        return [self._task(one) for one in sorted(drawings) if not self._read(one)]

    def keep(self, task: Task, execution: Execution) -> Iterator[str]:
        """Store the recording that a task of :meth:`missing` has made. If there is none, yield a sentence with why."""
        drawing = Drawing(task.assignment, int(task.notebook))
        recorded = execution.evidence.get(drawing.exercise, b"").decode()
        if recorded and not execution.trouble:
            file = self._file(drawing)
            file.parent.mkdir(mode=0o700, exist_ok=True)
            write_whole(file, msgspec.json.encode(KeptDrawing(task.seed, recorded)), mode=0o600)
            return
        verdicts = execution.verdicts.values()
        why = execution.trouble or next((one.diagnosis.text for one in verdicts if one.diagnosis), "")
        yield f"{drawing.exercise} could not be checked, because its solution could not be recorded: {why}"

    def _task(self, drawing: Drawing) -> Task:
        exercise, solution = exercises.get(drawing.exercise), _solution(drawing.exercise)
        check = CellCheck(exercise.id, exercise.title, exercise.points, exercise.points, exercise.limit)
        return Task(
            student="the solution",
            assignment=exercise.id,
            notebook=str(drawing.number),
            cells=(Cell(solution.source), Cell(solution.check_cell(exercise.id), check=check)),
            seed=self._made_from(drawing),
            course=_version(exercise.id),
            records=self._name(drawing),
            boxed=not self._directory.is_sandbox_off,
        )

    def _read(self, drawing: Drawing) -> str:
        try:
            kept = msgspec.json.decode(self._file(drawing).read_bytes(), type=KeptDrawing)
        except (OSError, msgspec.MsgspecError):
            return ""
        return kept.recorded if kept.made_from == self._made_from(drawing) else ""

    def _file(self, drawing: Drawing) -> Path:
        return self._directory.state / FOLDER / f"{drawing.exercise}-{drawing.number}.json"

    def _name(self, drawing: Drawing) -> str:
        words = f"drawing {drawing.number} of {drawing.exercise}".encode()
        return DRAWING + hmac.new(self._directory.secret, words, hashlib.sha256).hexdigest()[:32]

    def _made_from(self, drawing: Drawing) -> str:
        whole = " ".join(
            (self._name(drawing), _version(drawing.exercise), _solution(drawing.exercise).source)
        )
        return hashlib.sha256(whole.encode()).hexdigest()


def all_drawings(exercise_ids: Iterable[str]) -> list[Drawing]:
    """Return all drawings of those exercises that draw their inputs. Names of other cells with points are skipped."""
    return [Drawing(one, number) for one in exercise_ids if _is_drawn(one) for number in range(DRAWINGS)]


def drawings_of(task: Task) -> Iterator[Drawing]:
    """Yield the drawing that a task gets, for each of its exercises that draws its inputs."""
    for check in task.checks.values():
        if not check.asserts and _is_drawn(check.exercise):
            digest = hashlib.sha256(f"{task.seed} {check.exercise}".encode()).digest()
            yield Drawing(check.exercise, digest[0] % DRAWINGS)


def _is_drawn(exercise_id: str) -> bool:
    try:
        return exercises.get(exercise_id).is_drawn
    except (exercises.UnknownExercise, exercises.BrokenExercise):
        return False


@functools.cache
def _solution(exercise_id: str) -> ReferenceSolution:
    from autograder.masters.reference_solutions import reference_source  # imports jupytext, which takes long

    return reference_source(exercises.path(exercise_id).with_name(course.LAB), exercise_id)


@functools.cache
def _version(exercise_id: str) -> str:
    """Return a hash of the exercise, its reference output and the judge."""
    files = course_version.course_files()
    return files.version(JUDGE, SHARED, *files.labs(exercise_id.encode()))
