"""Computes hashes of the course's files: of all files, and of the parts on which results and pages depend."""

from __future__ import annotations

import functools
import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course
from autograder.exercises import MUTANTS, REFERENCE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_MADE_BY_PYTHON = "__pycache__"
_MADE_BY_COLCON = frozenset({"build", "install", "log"})
"""The folders that colcon makes next to a workspace's ``src``. They are not hashed, because they are made from the
files in ``src``, which are hashed.
"""
_OF_CHAPTERS = (f"*/{course.CHAPTER}", *(f"*/*/*{end}" for end in (".py", REFERENCE, MUTANTS, course.TICKET)))
"""Patterns for the chapters' files that the hash covers: ``chapter.toml``, exercises, reference outputs, what mutants
do, and tickets.
"""
_OF_GRADER = tuple(f"autograder/{part}/" for part in ("authoring", "cards", "cli", "grading"))
_EXECUTES_TASKS = tuple(f"autograder/grading/{part}/" for part in ("cluster", "running"))
JUDGE = "the judge"
"""The part of the course that executes and judges notebooks, for all exercises."""
GRADER = "the grader"
"""The part of the course that changes no result: it makes tasks from notebooks, and grades and pages from results.

If a changed grader makes a different task from a notebook, this task has no result yet, and so is executed.
"""
SHARED = "shared"
"""The part of ``solutions`` that all exercises share: the workspace, and the chapters' descriptions and interfaces."""


class CourseFiles:
    """The files of the course that run, judge or show submissions, in parts: see :func:`part_of`.

    Args:
        files: The name and the content of each file, as :func:`counted_files` names it.
    """

    def __init__(self, files: Iterable[tuple[str, bytes]]) -> None:
        self._parts: dict[str, bytearray] = {}
        for name, data in files:
            content = self._parts.setdefault(part_of(name), bytearray())
            content += f"{len(name)}:{name}{len(data)}:".encode() + data
        self._hashes = {part: hashlib.sha256(content).hexdigest() for part, content in self._parts.items()}

    def version(self, *parts: str) -> str:
        """Return a hash of some parts, in hexadecimal; of all if none is given."""
        chosen = sorted(self._hashes.keys() & set(parts or self._hashes))
        return hashlib.sha256(
            " ".join(f"{part} {self._hashes[part]}" for part in chosen).encode()
        ).hexdigest()[:16]

    def labs(self, text: bytes) -> set[str]:
        """Return the labs whose exercises may judge a notebook: those that it names, and that their files name in turn.

        Args:
            text: The source of the notebook.
        """
        labs: set[str] = set()
        others = self._parts.keys() - {JUDGE, GRADER, SHARED}
        while more := {lab for lab in others - labs if lab.encode() in text}:
            labs.update(more)
            text = b"".join(self._parts[lab] for lab in more)
        return labs


def part_of(name: str) -> str:
    """Return the part to which a file of the course belongs. Each lab is a part, named after its folder."""
    if name.startswith(_OF_GRADER) and not name.startswith(_EXECUTES_TASKS):
        return GRADER
    top, *folders, _ = name.split("/")
    if top != course.SOLUTIONS:
        return JUDGE
    is_lab = len(folders) == 2 and course.INTERFACES not in folders and not folders[0].endswith("ws")
    return folders[1] if is_lab else SHARED


@functools.cache
def course_files() -> CourseFiles:
    """Return the files of the course as they were at the first call."""
    return CourseFiles((name, path.read_bytes()) for name, path in counted_files())


def course_version() -> str:
    """Return a hash of all files of the course that run, judge or show submissions, in hexadecimal.

    All machines of a cluster must have the same hash, because otherwise they could give different grades.

    The hash covers the files of the folders ``autograder``, ``course_runtime`` and ``environment``, even those that
    seem to influence no grade. Of ``solutions/``, it covers the exercises, their reference outputs, the chapters'
    interfaces and the workspace. It does not cover the masters, because a class is graded by its own copies in
    ``source/``, whose changes are found separately.
    """
    return course_files().version()


def judged_by(source: bytes) -> str:
    """Return a hash of the code that executes a notebook, and of the exercises that judge it, in hexadecimal.

    Results are stored under this hash, so when it changes, for example after a fix of an exercise, graded submissions
    are executed again.

    Args:
        source: The source notebook.
    """
    files = course_files()
    return files.version(JUDGE, SHARED, *files.labs(source))


def counted_files() -> Iterator[tuple[str, Path]]:
    """Yield the files that the hash covers in a fixed order, each with a name that is the same on every machine."""
    root, package = course.root(), Path(course.__file__).parent
    solutions = root / "solutions"
    of_chapters = (*solutions.glob("*ws"), *solutions.glob(f"*/{course.INTERFACES}"))
    for folder in (package, package.with_name("course_runtime"), root / "environment", *sorted(of_chapters)):
        above = package.parent if folder.parent == package.parent else root
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
