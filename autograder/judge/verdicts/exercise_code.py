"""Reports exceptions in an exercise's own code, which the author of the exercise has to correct."""

from __future__ import annotations

import contextlib
import traceback
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises, kit
from autograder.judge.bench.wire import JudgeFailed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.kit.model import Exercise

WHAT_TO_DO = "Show this card to your instructor: the exercise has to be corrected first."
KIT = Path(kit.__file__).parent
MAX_WORDS = 300
"""The maximum length of the quoted error, in characters. It is limited because the error may contain output of the
subject.
"""


class ExerciseFailed(JudgeFailed):
    """The exercise's own code raised an exception."""


@contextlib.contextmanager
def of_exercise(exercise: Exercise) -> Iterator[None]:
    """Turn an exception in an exercise's own code into an :class:`ExerciseFailed`, which says what to do about it.

    Raises:
        ExerciseFailed: The code in the block raised an exception, and code of the exercise or of the kit called it.
    """
    try:
        yield
    except (JudgeFailed, OSError):
        raise
    except Exception as error:
        where = _where(error, exercise)
        if not where:
            raise
        words = " ".join(f"{type(error).__name__}: {error}".split())[:MAX_WORDS]
        raise ExerciseFailed(f"The exercise has a fault: {words} ({where}).\n{WHAT_TO_DO}") from error


def _where(error: Exception, exercise: Exercise) -> str:
    """Return the file and line of the exercise's code, or else of the kit's, that raised the error; empty if none."""
    frames = traceback.extract_tb(error.__traceback__)
    for folder in (exercises.path(exercise.id).parent, KIT):
        for frame in reversed(frames):
            if folder in Path(frame.filename).parents:
                return f"{Path(frame.filename).name}, line {frame.lineno}"
    return ""
