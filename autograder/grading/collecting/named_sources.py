"""What an instructor names is a list, a download or one student's own: so it is known which names may say a student.

This is decided here alone, by what is named and never by what lies within:

- **One student's own** is what a system or its own name says to be a student's, and every file that is no zip and no
  list. Its own name says whose it is, and nothing in it does. So it is with several folders that are named beside each
  other, as with ``repositories/*``, and with all zips and folders beside a name that a student may have chosen.
- **A download** is every other zip and folder. The names at its top say students, or, where one folder is around all,
  that one and those in it. Below them students have chosen the names.
"""

from __future__ import annotations

import functools
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.grading.collecting.archives import Boxes, File
from autograder.grading.collecting.lists import GRADESCOPE
from autograder.grading.collecting.unpack import EMPTY
from autograder.regular_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.grading.collecting.archives import Boxes, File
    from autograder.grading.collecting.student_of import StudentOf

_EXPORT = re2.compile(r"^assignment_\d+_export(?: ?\(\d+\)|-\d+)?$")
_SUBMISSION = re2.compile(r"^submission_\d+$")
# Names of downloads that look like those of Canvas's files: gradebook_ROS_101_2_2025-10-03-14-05-06.zip, as Blackboard
# makes them, and lab_1_2_submissions.zip.
_DOWNLOAD = re2.compile(r"^(?:gradebook_.*_\d{4}(?:-\d\d){5}(?: ?\(\d+\))?|\D+_\d_\d_[^_]+)\.zip$")


@dataclass(frozen=True)
class Source:
    """A download, or what is one student's own, with its files.

    Attributes:
        path: The file or folder that was named.
        files: All files in it; the file itself where it is one student's own.
        is_own: Whether it is one student's own.
    """

    path: Path
    files: tuple[File, ...]
    is_own: bool

    @functools.cached_property
    def levels(self) -> int:
        """The number of names, from the top of each path, that may say a student."""
        if self.is_own:
            return 1
        above = 1 if self.path.is_dir() else 0  # its own name, which says nobody
        return above + (2 if len({file.parts[above : above + 1] for file in self.files} - {()}) == 1 else 1)

    @property
    def download(self) -> Path:
        """The folder of what was named one by one, or the file or folder that all came in."""
        return self.path.absolute().parent if self.is_own else self.path

    def is_list(self, file: File, form: str) -> bool:
        """True if a file is the list that Gradescope puts into its export, and no student's of that name."""
        *above, name = file.parts or ("",)
        is_said = (
            name == GRADESCOPE and len(file.parts) <= self.levels and not any(map(_SUBMISSION.match, above))
        )
        return is_said and (form == "gradescope" or bool(above and _EXPORT.match(above[-1])))


def own_of(paths: Sequence[Path], student_of: StudentOf) -> set[Path]:
    """Those of the files and folders of one command that are one student's own."""
    beside = {path: path.absolute().parent for path in paths}
    by_system, loose = set(filter(student_of.has_form, paths)), set(filter(_is_loose, paths))
    # Beside a student's own file, such a name is one that a student may have chosen.
    downloads = {path for path in paths if _DOWNLOAD.match(name_as_text(path.name))}
    downloads -= {
        path for path in downloads if beside[path] in {beside[one] for one in (by_system | loose) - downloads}
    }
    called = (loose | set(filter(student_of.is_called, paths))) - downloads - by_system
    folders = Counter(beside[path] for path in paths if path.is_dir() and path not in by_system)
    chosen = {beside[path] for path in called} | {parent for parent, number in folders.items() if number > 1}
    return (by_system - downloads) | {path for path in paths if beside[path] in chosen}


def source_of(path: Path, boxes: Boxes, *, is_own: bool) -> Source:
    """A file or folder with all its files."""
    return Source(path, tuple(boxes.files_of(path, opened=not is_own)), is_own)


def note_on(source: Source, student_of: StudentOf, form: str) -> str:
    """What a file or folder was taken for, where its name leaves that open; empty where nobody has to know."""
    if not source.files:
        return f"{source.path} {EMPTY}"
    if not source.is_own and not form:
        return (
            f"{source.path} was taken for a download, in which names say whose work it is: if one student sent it, "
            "rename it to the student's id"
        )
    if source.is_own and not _is_loose(source.path) and not student_of.is_called(source.path):
        return (
            f"{source.path} was taken for one student's work, as its name or those beside it are: if it is a download "
            "or a list, rename it to submissions.zip or list.csv, and name it in a command of its own"
        )
    return ""


def _is_loose(path: Path) -> bool:
    """True of a file that is neither a download nor a list, whoever has named it."""
    return path.is_file() and path.suffix.lower() not in (".zip", ".csv")
