"""Tells the faults of an exercise's own code from what a subject does, and says what to do about them."""

from __future__ import annotations

import contextlib
import traceback
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises, kit
from autograder.judge.machine_fitness import JudgeFailed
from autograder.judge.verdicts.deciding import is_certain
from autograder.kit.evidence import Evidence

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.kit.evidence import Reference
    from autograder.kit.model import Exercise

WHAT_TO_DO = "Show this card to your instructor: the exercise has to be corrected first."
NOT_THE_EXERCISE = "Show this card to your instructor: the judge has to learn to read what your program does."
_KIT = Path(kit.__file__).parent
MAX_QUOTED_ERROR = 300
"""The maximum length of the quoted error, in characters. It is limited because the error may contain output of the
subject.
"""


class ExerciseFailed(JudgeFailed):
    """The code of an exercise or of the kit raised an exception."""


@contextlib.contextmanager
def of_exercise(exercise: Exercise, reference: Reference | None = None) -> Iterator[None]:
    """Turn an exception in an exercise's own code into an :class:`ExerciseFailed`, which says what to do about it.

    Args:
        reference: The recording of the reference solution; None if the solution is the subject.

    Raises:
        ExerciseFailed: The code in the block raised an exception, and code of the exercise or of the kit called it.
    """
    try:
        yield
    except (JudgeFailed, OSError):
        raise
    except Exception as error:
        where = _line_of_exercise(error, exercise)
        if not where:
            raise
        words = " ".join(f"{type(error).__name__}: {error}".split())[:MAX_QUOTED_ERROR]
        whose, what_to_do = "The exercise has a fault", WHAT_TO_DO
        if reference is not None and not _fails_on_solution(exercise, reference):
            whose, what_to_do = "The judge cannot read what your program did", NOT_THE_EXERCISE
        raise ExerciseFailed(f"{whose}: {words} ({where}).\n{what_to_do}") from error


def _fails_on_solution(exercise: Exercise, reference: Reference) -> bool:
    """Return True if the exercise's criteria or mistakes raise an exception about the reference solution, too.

    This decides no point: it tells whether the exercise is to blame for a check without a verdict.
    """
    solution = Evidence(reference.parts, reference)
    try:
        for criterion in exercise.criteria:
            criterion.judge(solution)
        is_certain(exercise, solution)
    except Exception:
        return True
    return False


def _line_of_exercise(error: Exception, exercise: Exercise) -> str:
    """Return the file and line of the exercise's code, or else of the kit's, that raised the error; empty if none."""
    frames = traceback.extract_tb(error.__traceback__)
    for folder in (exercises.path(exercise.id).parent, _KIT):
        for frame in reversed(frames):
            if folder in Path(frame.filename).parents:
                return f"{Path(frame.filename).name}, line {frame.lineno}"
    return ""
