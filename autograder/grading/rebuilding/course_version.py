"""A hash that changes whenever anything in the course changes that may influence a grade."""

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
"""Folders that are generated from files that are already counted. colcon makes them next to a workspace's ``src``."""
_OF_CHAPTERS = (f"*/{course.CHAPTER}", "*/*/*.py", f"*/*/*{REFERENCE}")
"""The files of the chapters that count: their descriptions, the exercises, and the reference outputs."""


@functools.cache
def course_version() -> str:
    """Return a hash of everything in the course that runs and judges submissions, in hexadecimal.

    The release number would not be enough: after an exercise is fixed, yesterday's results must not be reused.
    Results are stored under this hash, a graded submission is checked again when it changes, and all machines of a
    cluster must have the same hash.

    Every file of the package and of the environment counts, even one that seems to influence no grade, because a list
    of exceptions would be wrong one day. In ``solutions/``, the exercises, their reference outputs, the chapters'
    interfaces and the workspace count. The masters do not: a class has its own copy of them in ``source/``, which is
    compared separately.
    """
    digest = hashlib.sha256()
    for name, path in counted_files():
        data = path.read_bytes()
        digest.update(f"{len(name)}:{name}{len(data)}:".encode())
        digest.update(data)
    return digest.hexdigest()[:16]


def counted_files() -> Iterator[tuple[str, Path]]:
    """Yield the files that count, always in the same order, with names that are the same on every machine."""
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
