"""Feedback as one zip in the form in which an LMS takes files back: each page under the name of what it answers.

Moodle (*Upload multiple feedback files in a zip*) takes a page by the folder ``<name>_<number>_assignsubmission_file``;
Canvas (*Upload submissions*) by the numbers of student and file in the name that it gave the file.
"""

from __future__ import annotations

import io
import unicodedata
import zipfile
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from autograder.grading.collecting.forms import read_path
from autograder.grading.exporting.lms_gradebooks import known_there

if TYPE_CHECKING:
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.records import CollectedRecords
    from autograder.grading.table.class_table import ClassTable

FORMS = ("moodle", "canvas")
_MADE = (2000, 1, 1, 0, 0, 0)


def feedback_zip(
    directory: ClassDirectory, table: ClassTable, records: CollectedRecords, assignment: str, lms: str
) -> tuple[bytes, list[str]]:
    """The pages of one assignment.

    Args:
        directory: The class.
        table: The same.
        records: The record of what was collected.
        assignment: The assignment's name.
        lms: One of :data:`FORMS`.

    Returns:
        The zip, empty where there is no page for it, and the students who have a page but whose name in that LMS is not
        known.
    """
    data = io.BytesIO()
    unknown = []
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for student in table.students:
            pages = sorted((directory.path / "feedback" / student / assignment).glob("*.html"))
            if not pages:
                continue
            there = known_there(records, assignment, student, lms)
            if there is None:
                unknown.append(student)
                continue
            for page in pages:
                if lms == "canvas":
                    several = f"_{page.stem}" if len(pages) > 1 else ""
                    called = f"{_canvas(there.file)}{several}.html"
                else:
                    called = _moodle(table.roster.students[student].name or student, there.number, page.name)
                # The same class gives the same zip: no time of this machine is in it.
                archive.writestr(zipfile.ZipInfo(called, _MADE), page.read_bytes(), zipfile.ZIP_DEFLATED)
    return (data.getvalue() if archive.namelist() else b""), unknown


def _canvas(file: str) -> str:
    """The name that Canvas gave: of a zip that was unpacked the folder's, since what is in it the student has named."""
    parts = PurePosixPath(file).parts
    return PurePosixPath(next(one for one in parts if read_path((one,), "canvas", lambda _: False))).stem


def _moodle(name: str, number: str, page: str) -> str:
    plain = "".join(" " if character in "_/\\" else character for character in name)
    return f"{unicodedata.normalize('NFC', plain)}_{number}_assignsubmission_file/{page}"
