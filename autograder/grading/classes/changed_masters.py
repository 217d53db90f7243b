"""The masters from which the sources of a class were made, and which of these masters have changed since.

A class has its own copy of each assignment, which its instructor may change. The judge does not use that copy; it
judges by the current course. So the master from which a source was made is compared with the master as it is now.
Only the cells that are graded or answered count.
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
    """Record the masters from which sources were just made.

    Args:
        store: The store of the class.
        made: For each assignment, its master and the source that was made from it.
    """
    store.note_origins(
        {
            name: Origin(_in_course(master), _digest([master.read_text("utf-8")]), _work(notebook))
            for name, (master, notebook) in made.items()
        }
    )


def news(directory: ClassDirectory, store: ClassStore, assignments: Iterable[str]) -> list[str]:
    """Return warnings to show before grading, about masters that were changed since the class's sources were made.

    If it is unknown from which masters the sources were made, there is one warning about that.

    Args:
        directory: The class.
        store: The class's store, which contains the origin of each source: the master as it was then.
        assignments: The assignments to be graded.
    """
    known = store.origins()
    if not known:
        return [
            "This class was made by an older version, which did not record the masters of its sources. So it is "
            "unknown whether the course's tasks have changed since. The judge expects what the course says now. "
            "Compare a source with the course, or hand out and grade the new text, which then records its masters: "
            + course_command("renew-class", directory.path)
        ]
    return [warning(directory, name) for name in assignments if name in known and _has_moved(known[name])]


def warning(directory: ClassDirectory, assignment: str) -> str:
    """Return the warning about an assignment whose task has changed, with what to do."""
    return (
        f"{assignment}: its master in the course was changed since this class got its source. The judge expects what "
        "the course says now, so work that was written for the old text may fail. See first who would: "
        f"{course_command('grade', directory.path, '--dry-run')}. To hand out and grade the new text: "
        f"{course_command('renew-class', directory.path, '--assignment', assignment)}. "
        "To grade the old one: use the version of the course that it was handed out from."
    )


def _has_moved(origin: Origin) -> bool:
    master = course.root() / origin.master
    try:
        if _digest([master.read_text("utf-8")]) == origin.text:
            return False
        # Imported here because it takes a second and is rarely needed.
        from autograder.masters.source import source_notebook

        return _work(source_notebook(master)) != origin.work
    except (OSError, UnicodeDecodeError, MasterError):
        return False  # the course has been moved, or is being edited


def _in_course(master: Path) -> str:
    """Return the master's path relative to the course, so that the course may be moved; else the whole path."""
    path, root = master.resolve(), course.root().resolve()
    return str(path.relative_to(root) if path.is_relative_to(root) else path)


def _work(notebook: NotebookNode) -> str:
    marks = [(cell.metadata.get("nbgrader", {}), cell.source) for cell in notebook.cells]
    return _digest([source for mark, source in marks if mark.get("grade") or mark.get("solution")])


def _digest(parts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()
