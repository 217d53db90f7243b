"""One value that changes whenever something changes that may decide a grade."""

from __future__ import annotations

import functools
import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course
from autograder.exercises import REFERENCE

if TYPE_CHECKING:
    from collections.abc import Iterator

_MADE_BY_PYTHON = "__pycache__"
_MADE_BY_COLCON = frozenset({"build", "install", "log"})
"""Folders of what is made from the files that count; colcon's are beside the folder ``src`` of a workspace."""
_OF_CHAPTERS = (f"*/{course.CHAPTER}", "*/*/*.py", f"*/*/*{REFERENCE}")
"""The files of the chapters that count: their descriptions, the exercises and their reference outputs."""


@functools.cache
def course_version() -> str:
    """A hash of everything of the course that runs and judges submissions, as hexadecimal digits.

    A release number would not do: after an exercise is fixed, yesterday's results must not be reused. A result is
    kept under it, a graded submission is looked at again when it changes, and a cluster's machines must agree on it.

    Every file of the package and of the environment counts, also those of which one would say that no grade depends on
    them: such a list would be wrong one day. Of ``solutions/`` the exercises, their reference outputs, the chapters'
    interfaces and the workspace count. The masters do not: a class has its own copy in ``source/``, which is looked at
    there.
    """
    digest = hashlib.sha256()
    for name, path in counted_files():
        data = path.read_bytes()
        digest.update(f"{len(name)}:{name}{len(data)}:".encode())
        digest.update(data)
    return digest.hexdigest()[:16]


def counted_files() -> Iterator[tuple[str, Path]]:
    """The files that count, always in the same order, each with a name that is the same on every machine."""
    root, package = course.root(), Path(course.__file__).parent
    solutions = root / "solutions"
    of_chapters = (*solutions.glob("*ws"), *solutions.glob(f"*/{course.INTERFACES}"))
    for folder in (package, root / "environment", *sorted(of_chapters)):
        above = package.parent if folder == package else root
        for path in _files(folder):
            yield path.relative_to(above).as_posix(), path
    for pattern in _OF_CHAPTERS:
        for path in sorted(solutions.glob(pattern)):
            yield path.relative_to(root).as_posix(), path


def _files(folder: Path) -> Iterator[Path]:
    for where, folders, files in os.walk(folder):
        made = {_MADE_BY_PYTHON} | (_MADE_BY_COLCON if "src" in folders else set())
        folders[:] = sorted(name for name in folders if name not in made and not name.startswith("."))
        yield from (Path(where, name) for name in sorted(files) if not name.startswith("."))
