"""Bringing the sources of a class up to what the course says now."""

from __future__ import annotations

import shutil
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.classes.new_class import release, sources_of, write_source
from autograder.grading.errors import GradingError
from autograder.grading.following.origins import note_origins

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def renew(path: Path, course_root: Path, assignments: Sequence[str] = ()) -> list[str]:
    """Write the sources of a class anew from the course's masters, and its release from them.

    Args:
        path: The class directory.
        course_root: The folder that holds ``solutions``.
        assignments: Only these; all that the course has masters of by default.

    Returns:
        What was done, a line for each assignment.

    Raises:
        GradingError: An assignment is not the course's or not the class's, or nbgrader refuses the new text.
    """
    directory = ClassDirectory(path)
    there = directory.assignments()
    for name in assignments:
        if name not in there:
            raise GradingError(f"The class has no assignment {name}. It has: {', '.join(there)}.")
    made = {name: one for name, one in sources_of(course_root, assignments).items() if name in there}
    kept = directory.state / "sources-before" / f"{datetime.now(tz=UTC):%Y-%m-%dT%H-%M-%S.%f}"
    with directory.lock(), ClassStore(directory) as store:
        for name in made:
            shutil.copytree(directory.path / "source" / name, kept / name)
        try:
            for name, (_, notebook) in made.items():
                write_source(directory, name, notebook, there)
            release(directory, list(made))
        except GradingError:
            for name in made:
                shutil.copytree(kept / name, directory.path / "source" / name, dirs_exist_ok=True)
            raise
        note_origins(store, made)
    lines = [
        f"{name}: as the course has it now; hand out {directory.path / 'release' / name}" for name in made
    ]
    return [*lines, f"what was there before is in {kept}"]
