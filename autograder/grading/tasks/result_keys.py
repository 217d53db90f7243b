"""Computes from files what the result of a submission is made from, so that a run can skip unchanged submissions.

This saves time, because reading files is much faster than rebuilding notebooks: a class of a hundred students has a
thousand notebooks, and in most runs few of them are new. Only if a part of the key has changed are the notebooks of a
submission rebuilt and compared cell by cell.
"""

from __future__ import annotations

import functools
import hashlib
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.grading import course_version
from autograder.grading.class_records import ResultKey
from autograder.grading.classes.class_directory import CONFIG_NAME, SUFFIX, TIMESTAMP
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory, Submission


class ResultKeys:
    """Computes the keys of a class's submissions from the present files."""

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def of(self, submission: Submission) -> ResultKey:
        """Return the key that a result of the submission has if it is made now.

        The student's id is not part of it, so that a student who gets another id keeps the result.
        """
        names = (f"{name}{SUFFIX}" for name in self._notebooks(submission.assignment))
        handed_in = _digest(_content(submission.folder / name) for name in (*names, TIMESTAMP))
        return replace(self._of_assignment(submission.assignment), handed_in=handed_in)

    def of_sources(self) -> str:
        """Return a hash of everything from which the list of the cells with points is made."""
        sources = (self._released(assignment) for assignment in self._directory.assignments())
        return _digest([course_version.course_version(), self._configuration, *sources])

    @functools.cache  # noqa: B019  (lives as long as one batch)
    def _of_assignment(self, assignment: str) -> ResultKey:
        files = course_version.course_files()
        is_sandbox_off = str(self._directory.is_sandbox_off)
        return ResultKey(
            released=self._released(assignment),
            exercises=files.exercises(b"\n".join(self._sources(assignment).values())),
            judge=files.judge,
            settings=_digest([self._configuration, self._directory.secret.hex(), is_sandbox_off]),
            grader=files.grader,
        )

    def _released(self, assignment: str) -> str:
        files = self._sources(assignment).items()
        return _digest([assignment, *(f"{name} {_hash_of(data)}" for name, data in files)])

    @functools.cache  # noqa: B019
    def _sources(self, assignment: str) -> dict[str, bytes]:
        folder = self._directory.path / "source" / assignment
        paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
        return {str(path.relative_to(folder)): path.read_bytes() for path in paths}

    @functools.cached_property
    def _configuration(self) -> str:
        return _hash_of((self._directory.path / CONFIG_NAME).read_bytes())

    @functools.cache  # noqa: B019
    def _notebooks(self, assignment: str) -> list[str]:
        return self._directory.notebooks(assignment)


def _hash_of(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _content(path: Path) -> str:
    """Return a hash of a submitted file; if it cannot be read, return the reason."""
    try:
        return _hash_of(read_bytes(path))
    except UnreadableSubmission as error:
        return str(error)


def _digest(parts: Iterable[str]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(f"{len(part)}:{part};".encode())
    return digest.hexdigest()
