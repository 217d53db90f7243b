"""Computes a hash of all files of the course that may influence a grade."""

from __future__ import annotations

import functools
import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course
from autograder.exercises import REFERENCE
from autograder.kit.hunts.ticket import TICKET

if TYPE_CHECKING:
    from collections.abc import Iterator

_MADE_BY_PYTHON = "__pycache__"
_MADE_BY_COLCON = frozenset({"build", "install", "log"})
"""The folders that colcon makes next to a workspace's ``src``. They are not hashed, because they are made from the
files in ``src``, which are hashed.
"""
_OF_CHAPTERS = (f"*/{course.CHAPTER}", "*/*/*.py", f"*/*/*{REFERENCE}", f"*/*/*{TICKET}")
"""Patterns for the chapters' files that the hash covers: ``chapter.toml``, exercises, reference outputs and tickets."""


@functools.cache
def course_version() -> str:
    """Return a hash of all files of the course that run or judge submissions, in hexadecimal.

    Results are stored under this hash, so when it changes, for example after a fix of an exercise, graded submissions
    are run again. All machines of a cluster must have the same hash, because otherwise they could give different
    grades.

    The hash covers the files of the folders ``autograder`` and ``environment``, even files that seem to influence no
    grade. Of ``solutions/``, it covers the exercises, their reference outputs, the chapters' interfaces and the
    workspace. It does not cover the masters, because a class is graded by its own copies in ``source/``, whose changes
    are found separately.
    """
    digest = hashlib.sha256()
    for name, path in counted_files():
        data = path.read_bytes()
        digest.update(f"{len(name)}:{name}{len(data)}:".encode())
        digest.update(data)
    return digest.hexdigest()[:16]


def counted_files() -> Iterator[tuple[str, Path]]:
    """Yield the files that the hash covers in a fixed order, each with a name that is the same on every machine."""
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
        generated = {_MADE_BY_PYTHON} | (_MADE_BY_COLCON if "src" in folders else set())
        folders[:] = sorted(name for name in folders if name not in generated and not name.startswith("."))
        yield from (Path(where, name) for name in sorted(files) if not name.startswith("."))
