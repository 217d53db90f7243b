"""Warns before grading if a master has changed since a class got its source notebook from that master.

A class has its own copy of each notebook, in ``source``. But the judge uses the exercises of the current course, so it
may expect something that the copy does not ask for. Only changes of graded cells and answer cells are found.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from autograder import course
from autograder.grading.class_records import Origin
from autograder.grading.errors import course_command
from autograder.masters.master_errors import MasterError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from nbformat import NotebookNode

    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory


def note_origins(store: ClassStore, made: Mapping[str, tuple[Path, NotebookNode]]) -> None:
    """Record from which masters new source notebooks were made.

    Args:
        store: The store of the class.
        made: For each assignment, the path of its master and the new source notebook.
    """
    store.note_origins(
        {
            name: Origin(_in_course(master), _digest([master.read_text("utf-8")]), _work(notebook))
            for name, (master, notebook) in made.items()
        }
    )


def news(directory: ClassDirectory, store: ClassStore, assignments: Iterable[str]) -> list[str]:
    """Return a warning for each assignment whose master has changed since the class got its source notebook.

    If the class has no record of its masters, return one warning about that.

    Args:
        directory: The class.
        store: The class's store. It records for each source notebook its master, as the master was then.
        assignments: The assignments to be graded.
    """
    known = store.origins()
    if not known:
        return [
            "This class was made by an older version, so it is unknown whether the course's tasks have changed "
            "since. The judge expects what the tasks in the course ask for now. Compare a notebook in source with "
            "the course; or update the class's notebooks, and hand out the new ones: "
            + course_command("renew-class", directory.path)
        ]
    return [warning(directory, name) for name in assignments if name in known and _has_moved(known[name])]


def warning(directory: ClassDirectory, assignment: str) -> str:
    """Return the warning that the master of an assignment has changed."""
    return (
        f"{assignment}: the course's tasks have changed since this class got its notebook. The judge expects what the "
        "tasks ask for now, so answers to the old tasks may fail. To see whose points would change: "
        f"{course_command('grade', directory.path, '--dry-run')}. To hand out and grade the new tasks: "
        f"{course_command('renew-class', directory.path, '--assignment', assignment)}. "
        "To grade answers to the old tasks, use the version of the course that you handed out."
    )


def _has_moved(origin: Origin) -> bool:
    master = course.root() / origin.master
    try:
        if _digest([master.read_text("utf-8")]) == origin.text:
            return False
        # Imported here because this import takes a second and is rarely needed.
        from autograder.masters.source import source_notebook

        return _work(source_notebook(master)) != origin.work
    except (OSError, UnicodeDecodeError, MasterError):
        return False  # the master cannot be read, for example while an author edits it


def _in_course(master: Path) -> str:
    """Return the path of a master relative to the course, so that the course may be moved; or else the full path."""
    path, root = master.resolve(), course.root().resolve()
    return str(path.relative_to(root) if path.is_relative_to(root) else path)


def _work(notebook: NotebookNode) -> str:
    marks = [(cell.metadata.get("nbgrader", {}), cell.source) for cell in notebook.cells]
    return _digest([source for mark, source in marks if mark.get("grade") or mark.get("solution")])


def _digest(parts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()
