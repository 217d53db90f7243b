"""Computes the key of a submission's results from files, so that a run can skip unchanged submissions.

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
from autograder.grading.classes.class_directory import CONFIG_NAME, SUFFIX
from autograder.grading.course_version import GRADER, JUDGE, SHARED
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from autograder.grading.tasks.submission_times import read_timestamp

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
        names = self._directory.notebooks(submission.assignment)
        files = [_content(submission.folder / f"{name}{SUFFIX}") for name in names]
        handed_in = _hash_of([*files, read_timestamp(submission.folder)])
        return replace(self._of_assignment(submission.assignment), handed_in=handed_in)

    def of_sources(self) -> str:
        """Return a hash of everything from which the list of the cells with points is made."""
        return _hash_of(str(self._of_assignment(name)) for name in self._directory.assignments())

    @functools.cache  # noqa: B019  (lives as long as one batch)
    def _of_assignment(self, assignment: str) -> ResultKey:
        folder, files = self._directory.path / "source" / assignment, course_version.course_files()
        paths = [path for path in sorted(folder.rglob("*")) if path.is_file()]
        names = [str(path.relative_to(folder)) for path in paths]
        contents = [path.read_bytes() for path in paths]
        configuration = (self._directory.path / CONFIG_NAME).read_bytes()
        switches = (self._directory.is_sandbox_off, *self._directory.overlays)
        return ResultKey(
            released=_hash_of([assignment, *names, *contents]),
            exercises=files.version(SHARED, *files.labs(b"\n".join(contents))),
            judge=files.version(JUDGE),
            settings=_hash_of([configuration, self._directory.secret, *map(str, switches)]),
            grader=files.version(GRADER),
        )


def _content(path: Path) -> bytes | str:
    """Return the content of a submitted file; if it cannot be read, return the reason."""
    try:
        return read_bytes(path)
    except UnreadableSubmission as error:
        return str(error)


def _hash_of(parts: Iterable[bytes | str]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode("utf-8", "surrogateescape") if isinstance(part, str) else part
        digest.update(f"{len(data)}:".encode() + data)
    return digest.hexdigest()
