"""Packs feedback pages into a zip, with the names by which an LMS finds the students.

Each LMS finds the student of a page as follows. Moodle (*Upload multiple feedback files in a zip*): by the folder
``<name>_<number>_assignsubmission_file``. Canvas (*Upload submissions*): by the numbers of the student and of the file,
which are in the file name that Canvas made. Brightspace, Sakai and ILIAS (from memory): by the name of the student's
folder, which the LMS made.
"""

from __future__ import annotations

import io
import unicodedata
import zipfile
from pathlib import PurePath, PurePosixPath
from typing import TYPE_CHECKING

from autograder.grading.collecting.reading.lms_file_names import read_at
from autograder.grading.exporting.layouts import known_there

if TYPE_CHECKING:
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.records import CollectedRecords
    from autograder.grading.table.class_table import ClassTable

WAYS = {
    "moodle": "Upload multiple feedback files in a zip",
    "canvas": "Upload submissions",
    "brightspace": "Add Feedback Files",
    "sakai": "Upload All, Feedback Attachment(s)",
    "ilias": "Multi-Feedback",
}
"""For each LMS, the name of the page on which an instructor uploads the zip."""
_WITHIN = {"sakai": "Feedback Attachment(s)/"}
"""For each LMS that needs one, the folder for feedback pages inside a student's folder."""
_MADE = (2000, 1, 1, 0, 0, 0)


def feedback_zip(
    directory: ClassDirectory, table: ClassTable, records: CollectedRecords, assignment: str, lms: str
) -> tuple[bytes, list[str]]:
    """Return the feedback pages of one assignment as a zip, and the students whose page could not be included.

    Args:
        directory: The class.
        table: The table of the class.
        records: The records of what was collected.
        assignment: The assignment's name.
        lms: A key of :data:`WAYS`.

    Returns:
        The zip, empty if it would contain no page; and the students who have a page but whose name in that LMS is
        unknown.
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
                if lms == "moodle":
                    called = _moodle(table.roster.students[student].name or student, there.number, page.name)
                else:
                    called = _called(there.file, lms, page, is_one=len(pages) == 1)
                # The zip contains no time of this machine, so the same class gives the same zip.
                archive.writestr(zipfile.ZipInfo(called, _MADE), page.read_bytes(), zipfile.ZIP_DEFLATED)
    return (data.getvalue() if archive.namelist() else b""), unknown


def _called(file: str, lms: str, page: PurePath, *, is_one: bool) -> str:
    """Return the name of a page in the zip, derived from the name that the LMS gave to the student's file or folder.

    If the student handed in a zip that was unpacked, use the folder's name, because the student chose the names in the
    zip.
    """
    parts = PurePosixPath(file).parts
    place, found = next(
        (place, found)
        for place in range(len(parts))
        if (found := read_at(parts, place, lms, lambda _: False))
    )
    above, given = "".join(f"{one}/" for one in parts[:place]), parts[place]
    if lms == "canvas":
        return f"{PurePosixPath(given).stem}{'' if is_one else f'_{page.stem}'}.html"
    head = f"{given}/" if place < len(parts) - 1 else given.removesuffix(found.file)
    return f"{above}{head}{_WITHIN.get(lms, '')}{page.name}"


def _moodle(name: str, number: str, page: str) -> str:
    plain = "".join(" " if character in "_/\\" else character for character in name)
    return f"{unicodedata.normalize('NFC', plain)}_{number}_assignsubmission_file/{page}"
