"""The masters that the sources of a class were made of, and those that have changed since.

A class has its own copy of each assignment, which its instructor may change. The judge has none: it expects what the
course says today. So what is compared is a master then and now, and of it the cells that are graded or answered.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.errors import course_command
from autograder.masters.master_errors import MasterError
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from nbformat import NotebookNode

    from autograder.grading.classes.class_directory import ClassDirectory


class Origin(msgspec.Struct, frozen=True):
    """The origin of a source of a class.

    Attributes:
        master: The master's file.
        text: Stands for the whole of it.
        work: Stands for its graded cells and those that students write.
    """

    master: str
    text: str
    work: str


def remember(directory: ClassDirectory, made: Mapping[str, tuple[Path, NotebookNode]]) -> None:
    """Write down what sources were just made of.

    Args:
        directory: The class.
        made: The master and what came of it, by assignment.

    Raises:
        OSError: It could not be written.
    """
    known = _read(directory)
    for name, (master, notebook) in made.items():
        known[name] = Origin(str(master.absolute()), _digest([master.read_text("utf-8")]), _work(notebook))
    write_whole(_path(directory), msgspec.json.encode(known))


def moved_on(directory: ClassDirectory, assignments: Iterable[str]) -> list[str]:
    """The assignments whose masters ask for something else now than when the class got its sources."""
    known = _read(directory)
    return [name for name in assignments if name in known and _has_moved(known[name])]


def news(directory: ClassDirectory, assignments: Iterable[str]) -> list[str]:
    """The note before a class is graded: the tasks that were changed since, or that nobody can know.

    Args:
        directory: The class.
        assignments: Those that are graded.
    """
    if not _path(directory).exists():
        return [
            "This class was made before classes wrote down what their sources were made of, so nobody can tell whether "
            "the course asks for something else by now. The judge expects what the course says now. Compare a source "
            "with what the course has, or hand out and grade the new text; then it is written down: "
            + course_command("renew-class", directory.path)
        ]
    return [warning(directory, name) for name in moved_on(directory, assignments)]


def warning(directory: ClassDirectory, assignment: str) -> str:
    """The warning about such an assignment, and what to do."""
    return (
        f"{assignment}: its master in the course was changed since this class got its source. The judge expects what "
        "the course says now, so work that was written for the old text may fail. See first who would: "
        f"{course_command('grade', directory.path, '--dry-run')}. To hand out and grade the new text: "
        f"{course_command('renew-class', directory.path, '--assignment', assignment)}. "
        "To grade the old one: use the version of the course that it was handed out from."
    )


def _has_moved(origin: Origin) -> bool:
    master = Path(origin.master)
    try:
        if _digest([master.read_text("utf-8")]) == origin.text:
            return False
        from autograder.masters.source import source_notebook  # a second, mostly for nothing

        return _work(source_notebook(master)) != origin.work
    except (OSError, UnicodeDecodeError, MasterError):
        return False  # the course is elsewhere now, or being worked on


def _work(notebook: NotebookNode) -> str:
    marks = [(cell.metadata.get("nbgrader", {}), cell.source) for cell in notebook.cells]
    return _digest([source for mark, source in marks if mark.get("grade") or mark.get("solution")])


def _digest(parts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _path(directory: ClassDirectory) -> Path:
    return directory.state / "masters.json"


def _read(directory: ClassDirectory) -> dict[str, Origin]:
    try:
        return msgspec.json.decode(_path(directory).read_bytes(), type=dict[str, Origin])
    except (OSError, msgspec.MsgspecError):
        return {}
