"""One notebook begun anew: the released one is put in its place, and the student's is kept beside it."""

from __future__ import annotations

import difflib
import time
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING

from autograder import course
from autograder.regular_files import write_whole
from autograder.student import journal
from autograder.student.standing import notebook_path

if TYPE_CHECKING:
    from pathlib import Path


class CannotReset(Exception):
    """The notebook stays as it is; the message says why and what to do."""


@dataclass(frozen=True)
class Reset:
    """The result of a reset.

    Attributes:
        notebook: Where the released notebook is now.
        copy: The student's own; None where there was none, or nothing had been changed in it.
    """

    notebook: Path
    copy: Path | None


def reset(root: Path, folder: Path, name: str, entries_in: Path | None = None) -> Reset:
    """Put a notebook back as it was released, and keep the student's.

    Args:
        root: The course.
        folder: That of the notebooks.
        name: Of the notebook, such as ``"lab_1_2"``; a path to it will do.
        entries_in: The journal, in which its points begin anew; this session's own where not given.

    Raises:
        CannotReset: There is no such notebook, or nothing can be written there.
        BrokenChapter: A chapter's description cannot be used.
    """
    chapter, lab = _find(root, name)
    path = notebook_path(chapter, lab, folder)
    fresh = released_text(lab)
    try:
        copy = _keep(path) if path.exists() and path.read_bytes() != fresh else None
        write_whole(path, fresh)
    except OSError as error:
        raise CannotReset(f"{path} cannot be put back: {error.strerror or error}") from error
    journal.note(journal.Entry("reset", lab.name, time.time()), entries_in)
    return Reset(path, copy)


def released_text(lab: Path) -> bytes:
    """A lab's notebook as it is released: kept in what students are handed, else derived from its master."""
    kept = course.released(lab)
    if kept.is_file():
        return kept.read_bytes()
    from autograder.masters.release import release_text  # no part of what students are handed
    from autograder.masters.source import source_notebook

    return release_text(source_notebook(lab / course.LAB)).encode()


def _find(root: Path, name: str) -> tuple[course.Chapter, Path]:
    wanted = PurePath(name).name.removesuffix(".ipynb")
    labs = {lab.name: (chapter, lab) for chapter in course.chapters(root) for lab in chapter.labs}
    if wanted not in labs:
        near = difflib.get_close_matches(wanted, labs, n=3, cutoff=0.4) or list(labs)
        raise CannotReset(f"no notebook is called {wanted!r}; did you mean {' or '.join(near)}?")
    return labs[wanted]


def _keep(path: Path) -> Path:
    """Copy a notebook beside itself, under a name that nothing has yet."""
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
