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
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.running.batch_progress import BatchProgress
    from autograder.grading.running.execution_backends import Execute

FOLDER = "drawings"
"""The name of the folder in the class's state folder. No box sees this folder."""
DRAWINGS = 16
"""The number of drawings of an exercise in a class."""


class Drawing(NamedTuple):
    """One of the drawings of an exercise in a class; ``number`` is less than :data:`DRAWINGS`."""

    exercise: str
    number: int


class _KeptDrawing(msgspec.Struct, frozen=True):
    """The content of a file.

    Attributes:
        made_from: The hash of everything from which the drawing was recorded.
        recorded: The recording, as JSON.
    """

    made_from: str
    recorded: str


class _Solution(NamedTuple):
    """The code of a solution and of its check; or the reason why the master cannot be used."""

    source: str = ""
    check: str = ""
    problem: str = ""


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

        If the master of an exercise cannot be used, the task has a ``problem`` and cannot be executed.
        """
        return [self._task(one) for one in sorted(drawings) if not self._read(one)]

    def record(self, missing: Sequence[Task], execute: Execute, progress: BatchProgress) -> dict[str, str]:
        """Execute the tasks of :meth:`missing`, and store the recordings.

        Args:
            missing: The tasks.
            execute: Executes them.
            progress: Shows which task begins and ends.

        Returns:
            For each exercise of which a drawing could not be recorded, the reason.
        """
        reasons = {task.assignment: task.problem for task in missing if task.problem}
        can_run = (task for task in missing if not task.problem)
        for done in execute(can_run, on_start=lambda task: progress.started(task.label)):
            task, execution = done.task, done.execution
            progress.finished(task.label, failed=bool(execution.trouble))
            recorded = execution.evidence.get(task.assignment, b"").decode()
            if recorded and not execution.trouble:
                file = self._file(Drawing(task.assignment, int(task.notebook)))
                file.parent.mkdir(mode=0o700, exist_ok=True)
                write_whole(file, msgspec.json.encode(_KeptDrawing(task.seed, recorded)), mode=0o600)
            else:
                diagnosis = execution.verdicts[len(task.cells) - 1].diagnosis
                reasons[task.assignment] = execution.trouble or (
                    diagnosis.text if diagnosis else "no recording"
                )
        return reasons

    def _task(self, drawing: Drawing) -> Task:
        exercise, solution = exercises.get(drawing.exercise), self._solution(drawing.exercise)
        check = CellCheck(exercise.id, exercise.title, exercise.points, exercise.points, exercise.limit)
        return Task(
            student="the solution",
            assignment=exercise.id,
            notebook=str(drawing.number),
            cells=(Cell(solution.source), Cell(solution.check, check=check)),
            seed=self._made_from(drawing),
            course=self._version(exercise.id),
            records=self._name(drawing),
            problem=solution.problem,
            boxed=not self._directory.is_sandbox_off,
        )

    @functools.cache  # noqa: B019  (lives as long as one batch)
    def _solution(self, exercise_id: str) -> _Solution:
        # Imported here, because these import jupytext, which takes long.
        from autograder.masters.master_files import MasterError
        from autograder.masters.reference_solutions import reference_source

        try:
            found = reference_source(exercises.path(exercise_id).with_name(course.LAB), exercise_id)
        except (MasterError, OSError) as error:
            return _Solution(problem=str(error))
        return _Solution(found.source, found.check_cell(exercise_id))

    @functools.cache  # noqa: B019  (the same)
    def _version(self, exercise_id: str) -> str:
        """Return a hash of the exercise, its reference output and the judge."""
        files = course_version.course_files()
        return files.version(JUDGE, SHARED, *files.labs(exercise_id.encode()))

    def _read(self, drawing: Drawing) -> str:
        try:
            kept = msgspec.json.decode(self._file(drawing).read_bytes(), type=_KeptDrawing)
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
            (self._name(drawing), self._version(drawing.exercise), self._solution(drawing.exercise).source)
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
