"""Computes a fingerprint of a submission from its files, so that a run can skip submissions that are unchanged.

This saves time, because reading files is much faster than rebuilding notebooks: a class of a hundred students has a
thousand notebooks, and in most runs few of them are new. Only if the fingerprint of a submission has changed are its
notebooks rebuilt and compared cell by cell.
"""

from __future__ import annotations

import functools
import hashlib
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import CONFIG_NAME, SUFFIX, TIMESTAMP
from autograder.grading.course_version import course_version
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from autograder.grading.classes.class_directory import ClassDirectory, Submission


class Fingerprints:
    """Computes the fingerprints of a class's submissions."""

    def __init__(self, directory: ClassDirectory) -> None:
        self._directory = directory

    def of(self, submission: Submission) -> str:
        """Return a hash of all files that influence the grade and the feedback of a submission.

        The student's id is not part of it, so that a student who gets another id keeps the result.
        """
        files = [submission.folder / f"{name}{SUFFIX}" for name in self._notebooks(submission.assignment)]
        return _digest(
            [
                self.of_sources(submission.assignment),
                self._directory.secret.hex(),
                str(self._directory.is_sandbox_off),
                *(_content(file) for file in (*files, submission.folder / TIMESTAMP)),
            ]
        )

    @functools.cache  # noqa: B019  (lives as long as one batch)
    def of_sources(self, assignment: str) -> str:
        """Return a hash of an assignment's source files, the class's configuration and the course's code."""
        folder = self._directory.path / "source" / assignment
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        return _digest(
            [
                course_version(),
                _trusted(self._directory.path / CONFIG_NAME),
                assignment,
                *(f"{path.relative_to(folder)} {_trusted(path)}" for path in files),
            ]
        )

    @functools.cache  # noqa: B019
    def _notebooks(self, assignment: str) -> list[str]:
        return self._directory.notebooks(assignment)


def _trusted(path: Path) -> str:
    """Return a hash of an instructor's file, which, unlike a submitted file, may be a link."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _content(path: Path) -> str:
    """Return a hash of a submitted file; if it cannot be read, return the reason."""
    try:
        return hashlib.sha256(read_bytes(path)).hexdigest()
    except UnreadableSubmission as error:
        return str(error)


def _digest(parts: Iterable[str]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(f"{len(part)}:{part};".encode())
    return digest.hexdigest()
