"""Computes hashes of the course's files: of all files, and of the parts on which results and pages depend."""

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
    from collections.abc import Iterable, Iterator, Mapping

_MADE_BY_PYTHON = "__pycache__"
_MADE_BY_COLCON = frozenset({"build", "install", "log"})
"""The folders that colcon makes next to a workspace's ``src``. They are not hashed, because they are made from the
files in ``src``, which are hashed.
"""
_OF_CHAPTERS = (f"*/{course.CHAPTER}", "*/*/*.py", f"*/*/*{REFERENCE}", f"*/*/*{TICKET}")
"""Patterns for the chapters' files that the hash covers: ``chapter.toml``, exercises, reference outputs and tickets."""
_GRADER = tuple(f"autograder/{part}/" for part in ("authoring", "cards", "cli", "grading"))
"""The folders of the grader: the code that makes tasks from notebooks, and grades and pages from results."""
_EXECUTES_TASKS = tuple(f"autograder/grading/{part}/" for part in ("cluster", "running"))
"""The folders inside ``grading`` that belong to the judge's part, because they execute tasks."""
_BEFORE_PARTS = ("42e9eafef104ffd0", "6914a5659ef8f202")
"""The last version of the course that had one hash for all files, and what ``without_grader`` is for its files.

A class that was begun with this version keeps its results until a file on which results depend has changed.
"""


class CourseFiles:
    """The files of the course that run, judge or show submissions.

    Args:
        contents: The content of each file, by the name that :func:`counted_files` gives it.
    """

    def __init__(self, contents: Mapping[str, bytes]) -> None:
        self._contents = contents

    @functools.cached_property
    def whole(self) -> str:
        """A hash of all files."""
        return self._hash_of(self._contents)

    @functools.cached_property
    def without_grader(self) -> str:
        """A hash of all files on which the result of a notebook may depend."""
        return self._hash_of(name for name in self._contents if not _in_grader(name))

    @functools.cached_property
    def judge(self) -> str:
        """A hash of the code that executes and judges notebooks, for all exercises."""
        return self._hash_of(name for name in self._contents if not (_in_solutions(name) or _in_grader(name)))

    @functools.cached_property
    def grader(self) -> str:
        """A hash of the grader's code, which changes no result: it makes tasks, enters results and makes pages.

        If it makes a different task from a notebook, this task has no result yet, and so is executed.
        """
        return self._hash_of(filter(_in_grader, self._contents))

    def exercises(self, text: bytes) -> str:
        """Return a hash of the exercises that may judge a notebook.

        These are all exercises of the labs that the notebook names, and of the labs that their files name in turn.
        The hash also covers what all exercises share: the workspace and the chapters' interfaces.

        Args:
            text: The source of the notebook.
        """
        return self._of_labs(frozenset(self._named_in(text)))

    @functools.cached_property
    def _labs(self) -> dict[str, list[str]]:
        """The names of each lab's files, by the folder of the lab; under the key ``""`` the shared files."""
        labs: dict[str, list[str]] = {"": []}
        for name in filter(_in_solutions, self._contents):
            labs.setdefault(_lab_of(name), []).append(name)
        return labs

    def _named_in(self, text: bytes) -> Iterator[str]:
        return (lab for lab in self._labs if lab and lab.encode() in text)

    @functools.cache  # noqa: B019  (lives as long as the process)
    def _of_labs(self, labs: frozenset[str]) -> str:
        names = [name for lab in self._labs if lab in labs for name in self._labs[lab]]
        more = labs.union(*(self._named_in(self._contents[name]) for name in names))
        return self._of_labs(more) if more != labs else self._hash_of([*self._labs[""], *names])

    def _hash_of(self, names: Iterable[str]) -> str:
        digest = hashlib.sha256()
        for name in names:
            data = self._contents[name]
            digest.update(f"{len(name)}:{name}{len(data)}:".encode())
            digest.update(data)
        return digest.hexdigest()[:16]


def _in_solutions(name: str) -> bool:
    return name.startswith(f"{course.SOLUTIONS}/")


def _in_grader(name: str) -> bool:
    return name.startswith(_GRADER) and not name.startswith(_EXECUTES_TASKS)


def _lab_of(name: str) -> str:
    """Return the folder of the lab that contains a file of ``solutions``; empty if all labs share the file."""
    _, chapter, lab, *file = name.split("/")
    return lab if len(file) == 1 and not chapter.endswith("ws") else ""


@functools.cache
def course_files() -> CourseFiles:
    """Return the files of the course as they were at the first call."""
    return CourseFiles({name: path.read_bytes() for name, path in counted_files()})


def course_version() -> str:
    """Return a hash of all files of the course that run, judge or show submissions, in hexadecimal.

    All machines of a cluster must have the same hash, because otherwise they could give different grades.

    The hash covers the files of the folders ``autograder`` and ``environment``, even files that seem to influence no
    grade. Of ``solutions/``, it covers the exercises, their reference outputs, the chapters' interfaces and the
    workspace. It does not cover the masters, because a class is graded by its own copies in ``source/``, whose changes
    are found separately.
    """
    return course_files().whole


def judged_by(source: bytes) -> str:
    """Return a hash of the code that executes a notebook, and of the exercises that judge it, in hexadecimal.

    Results are stored under this hash, so when it changes, for example after a fix of an exercise, graded submissions
    are executed again.

    Args:
        source: The source notebook.
    """
    files = course_files()
    before, same = _BEFORE_PARTS
    if files.without_grader == same:
        return before
    return hashlib.sha256(f"{files.judge} {files.exercises(source)}".encode()).hexdigest()[:16]


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
