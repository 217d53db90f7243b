"""Finds the exercises in the labs' folders, and imports the module of an exercise at its first use.

The exercise ``lab_1_2.talker`` is the file ``talker.py`` in the folder ``lab_1_2`` of a chapter. Python can import it
as the module ``lab_1_2.talker``, so the files of a lab can import each other. A file whose name begins with an
underscore is not an exercise, but a part of other exercises. A ticket (``dark_door.ticket.toml``) is two exercises
without files of their own. Only judges and graders import these modules; no student's
sandbox contains the files.
"""

from __future__ import annotations

import contextlib
import difflib
import functools
import sys
import traceback
from importlib import import_module
from importlib.machinery import ModuleSpec
from typing import TYPE_CHECKING

from autograder import course

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from types import ModuleType

    from autograder.kit.model import Exercise

REFERENCE = ".reference.json"
"""The suffix of the file next to an exercise that contains the exercise's reference output."""
MUTANTS = ".mutants.json"
"""The suffix of the packed file next to it: what the mutants of the solution do."""


class UnknownExercise(LookupError):
    """No exercise has this id. The message names exercises with similar ids."""


class BrokenExercise(Exception):
    """A file in a lab's folder is not a valid exercise. The message says why."""


def all_ids() -> tuple[str, ...]:
    """Return the ids of all exercises, in the order of the course."""
    return tuple(_files())


def get(exercise_id: str) -> Exercise:
    """Return the exercise with this id.

    Raises:
        UnknownExercise: No exercise has this id.
        BrokenExercise: The exercise's file cannot be imported, or does not define an exercise with this id; or its
            ticket cannot be used.
    """
    file = path(exercise_id)
    try:
        exercise: Exercise | None = _of_ticket(file) or getattr(import_module(exercise_id), "EXERCISE", None)
    except Exception as error:
        raise BrokenExercise(f"{file} cannot be imported: {_words(error)}") from error
    if exercise is None:
        raise BrokenExercise(
            f"{file} does not define EXERCISE: name the file _{file.name} if it is a part of other exercises"
        )
    if exercise.id != exercise_id:
        raise BrokenExercise(f"{file} defines the exercise {exercise.id!r}: its id has to be {exercise_id!r}")
    return exercise


# The results of this function and of `_files_of` are cached, because a judge cannot read the labs' folders any more
# when it is in its sandbox. Python itself keeps the modules.
@functools.cache
def _of_ticket(file: Path) -> Exercise | None:
    """Return the exercise of a ticket; None if an exercise has a file of its own."""
    from autograder.kit.hunts.ticket import exercise_of

    return None if file.exists() else exercise_of(file)


def unbroken() -> tuple[Exercise, ...]:
    """Return all exercises except broken ones, for example one that its author is still writing."""
    found = []
    for exercise_id in all_ids():
        with contextlib.suppress(BrokenExercise):
            found.append(get(exercise_id))
    return tuple(found)


def path(exercise_id: str) -> Path:
    """Return the file of an exercise.

    Raises:
        UnknownExercise: The exercise does not exist.
    """
    files = _files()
    if not files:
        raise UnknownExercise(f"no exercise was found in {course.root() / course.SOLUTIONS}")
    if exercise_id not in files:
        near = difflib.get_close_matches(exercise_id, files, n=3, cutoff=0.4) or list(files)
        raise UnknownExercise(f"no exercise is called {exercise_id!r}; did you mean {' or '.join(near)}?")
    return files[exercise_id]


def reference_path(exercise_id: str) -> Path:
    """Return the path of an exercise's reference output.

    Raises:
        UnknownExercise: The exercise does not exist.
    """
    return path(exercise_id).with_suffix(REFERENCE)


def mutants_path(exercise_id: str) -> Path:
    """Return the path of the file with what the mutants of an exercise's solution do.

    Raises:
        UnknownExercise: The exercise does not exist.
    """
    return path(exercise_id).with_suffix(MUTANTS)


def grade_id(exercise_id: str) -> str:
    """Return nbgrader's grade_id for an exercise's check cell: the id with ``-`` for the dot, as nbgrader requires."""
    return exercise_id.replace(".", "-")


def _words(error: Exception) -> str:
    """Return an error that an import raised as one line of text, with the file and line."""
    kind = type(error).__name__
    if isinstance(error, SyntaxError):
        return f"{kind}: {error.msg} ({error.filename}, line {error.lineno})"
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{kind}: {error} ({last.filename}, line {last.lineno})"


def _files() -> dict[str, Path]:
    return _files_of(course.root())


@functools.cache
def _files_of(root: Path) -> dict[str, Path]:
    return {
        exercise_id: file
        for chapter in course.chapters(root)
        for lab in chapter.labs
        for exercise_id, file in chapter.exercises_of(lab).items()
    }


class _LabsFinder:
    """Makes Python find the folder of a lab, in any chapter, as a package."""

    @staticmethod
    def find_spec(
        name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the package of a lab; see :class:`importlib.abc.MetaPathFinder`."""
        del target
        folder = None if path is not None else _folders().get(name)
        if folder is None:
            return None
        spec = ModuleSpec(name, None, is_package=True)
        spec.submodule_search_locations = [str(folder)]
        return spec


def _folders() -> dict[str, Path]:
    try:
        return {file.parent.name: file.parent for file in _files().values()}
    except course.NoCourse:
        return {}


sys.meta_path.append(_LabsFinder)
