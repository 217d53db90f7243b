"""Decides which paths of a command are downloads, and which are the work of one student.

Only the names on the command line decide, never the contents:

- **The work of one student**: a file or folder with a name that an LMS gives to the work of one student. If the command
  also names a file that is neither a zip nor a list, a path with the name of a student, or several folders, as with
  ``repositories/*``, then each of its paths is the work of one student. Names inside such a path identify no student.
- **A download**: every other zip and folder. The names at its top identify students. If a single folder at the top
  contains everything else, the names in that folder identify students, too. Names further down do not, because students
  have chosen them.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.grading.collecting.reading.lists import GRADESCOPE
from autograder.grading.collecting.reading.unpack import EMPTY
from autograder.regular_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.grading.collecting.deciding.student_of import StudentOf
    from autograder.grading.collecting.inbox import Arrival
    from autograder.grading.collecting.reading.archives import File

_EXPORT = re2.compile(r"^assignment_\d+_export(?: ?\(\d+\)|-\d+)?$")
_SUBMISSION = re2.compile(r"^submission_\d+$")
# These are downloads, although their names look like names of files in Canvas:
# gradebook_ROS_101_2_2025-10-03-14-05-06.zip, as Blackboard makes it, and lab_1_2_submissions.zip.
_DOWNLOAD = re2.compile(r"^(?:gradebook_.*_\d{4}(?:-\d\d){5}(?: ?\(\d+\))?|\D+_\d_\d_[^_]+)\.zip$")


@dataclass(frozen=True)
class NamedSource:
    """A download, or the files of one student.

    Attributes:
        path: The file or folder that the instructor named.
        files: All files in it, or the file itself.
        is_own: True if all files belong to one student.
    """

    path: Path
    files: tuple[File, ...]
    is_own: bool

    @functools.cached_property
    def levels(self) -> int:
        """Return how many names at the top of each path may identify a student, because no student has chosen them."""
        if self.is_own:
            return 1
        above = 1 if self.path.is_dir() else 0  # the name of the folder itself, which identifies no student
        return above + (
            2 if len({file.arrival.parts[above : above + 1] for file in self.files} - {()}) == 1 else 1
        )

    def is_list(self, arrival: Arrival, form: str) -> bool:
        """Return True if a file is the list in Gradescope's export, and not a student's file with that name."""
        *above, name = arrival.parts or ("",)
        is_said = (
            name == GRADESCOPE
            and len(arrival.parts) <= self.levels
            and not any(map(_SUBMISSION.match, above))
        )
        return is_said and (form == "gradescope" or bool(above and _EXPORT.match(above[-1])))


def own_of(paths: Sequence[Path], student_of: StudentOf) -> set[Path]:
    """Return the paths of a command that are each the work of one student."""
    formed = set(filter(student_of.has_form, paths))
    downloads = {path for path in paths if _DOWNLOAD.match(name_as_text(path.name))}
    others = set(paths) - formed
    if sum(path.is_dir() for path in others) > 1 or any(
        _is_loose(path) or student_of.is_called(path) for path in others - downloads
    ):
        return set(paths)
    # A name of a known download means a download. But next to one student's work, a student may have chosen this name,
    # too.
    return formed if formed - downloads else set()


def note_on(source: NamedSource, student_of: StudentOf, form: str) -> str:
    """Return a sentence about how a path was interpreted, if its name leaves that open; otherwise an empty text."""
    if not source.files:
        return f"{source.path} {EMPTY}"
    if not source.is_own and not form:
        return (
            f"{source.path} was taken for a download, in which names identify the students: if one student sent "
            "the file, rename it to the student's id"
        )
    if source.is_own and not _is_loose(source.path) and not student_of.is_called(source.path):
        return (
            f"{source.path} was taken for one student's work because of its name or the other paths of the command: if "
            "it is a download or a list, rename it to submissions.zip or list.csv, and collect it in a separate command"
        )
    return ""


def _is_loose(path: Path) -> bool:
    """Return True if a path is a file that is neither a download nor a list."""
    return path.is_file() and path.suffix.lower() not in (".zip", ".csv")
