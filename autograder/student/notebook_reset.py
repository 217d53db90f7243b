"""Resets a notebook: restores the released one, and keeps a copy of the student's notebook next to it."""

from __future__ import annotations

import difflib
import time
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING

from autograder import course
from autograder.check_journal import JournalEntry, note
from autograder.safe_files import write_whole
from autograder.student.progress import notebook_path

if TYPE_CHECKING:
    from pathlib import Path


class CannotReset(Exception):
    """The notebook was not reset. The message says why, and what to do."""


@dataclass(frozen=True)
class Reset:
    """The result of a reset.

    Attributes:
        notebook: The path of the restored notebook.
        copy: The path of the copy of the student's notebook; None if there was no notebook, or it was unchanged.
    """

    notebook: Path
    copy: Path | None


def reset(root: Path, folder: Path, name: str, entries_in: Path | None = None) -> Reset:
    """Restore a released notebook, and keep a copy of the student's notebook.

    Args:
        root: The top folder of the course.
        folder: The folder of the notebooks.
        name: The name of the notebook, such as ``"lab_1_2"``, or a path to it.
        entries_in: The journal in which the points are reset; by default this session's.

    Raises:
        CannotReset: The notebook does not exist, or its folder cannot be written to.
        BrokenChapter: A chapter's description cannot be used.
    """
    chapter, lab = _find(root, name)
    path = notebook_path(chapter, lab, folder)
    fresh = _released_text(lab)
    try:
        copy = _keep(path) if path.exists() and path.read_bytes() != fresh else None
        write_whole(path, fresh)
    except OSError as error:
        raise CannotReset(f"{path} cannot be restored: {error.strerror or error}") from error
    note(JournalEntry("reset", lab.name, time.time()), entries_in)
    return Reset(path, copy)


def _released_text(lab: Path) -> bytes:
    """Return a lab's notebook as it was released: from the hand-out, or else made from the master."""
    kept = course.released(lab)
    if kept.is_file():
        return kept.read_bytes()
    # Import these modules only here, because a hand-out does not contain them.
    from autograder.masters.notebook_release import release_text
    from autograder.masters.source_notebooks import source_notebook

    return release_text(source_notebook(lab / course.LAB)).encode()


def _find(root: Path, name: str) -> tuple[course.Chapter, Path]:
    wanted = PurePath(name).name.removesuffix(".ipynb")
    labs = {lab.name: (chapter, lab) for chapter in course.chapters(root) for lab in chapter.labs}
    if wanted not in labs:
        near = difflib.get_close_matches(wanted, labs, n=3, cutoff=0.4) or list(labs)
        raise CannotReset(f"no notebook is called {wanted!r}; did you mean {' or '.join(near)}?")
    return labs[wanted]


def _keep(path: Path) -> Path:
    """Copy a notebook within its folder, to a name that does not exist yet. Return the path of the copy."""
    day = time.strftime("%Y-%m-%d")
    for number in range(1, 1000):
        again = f", {number}" if number > 1 else ""
        copy = path.with_name(f"{path.stem} {course.COPY} {day}{again}).ipynb")
        try:
            with copy.open("xb") as file:
                file.write(path.read_bytes())
        except FileExistsError:
            continue
        return copy
    raise CannotReset(f"there are a thousand copies of {path.name}: delete some")
