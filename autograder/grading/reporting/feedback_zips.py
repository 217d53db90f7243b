"""Makes the zips of feedback pages that learning management systems (LMS) take back.

Each LMS finds the student of a feedback page in a zip as follows. Moodle (*Upload multiple feedback files in a zip*):
by the folder ``<name>_<number>_assignsubmission_file``. Canvas (*Upload submissions*): by the numbers of the student
and of the file, which are in the file name that Canvas made. Brightspace, Sakai and ILIAS (from memory): by the name of
the student's folder, which the LMS made.
"""

from __future__ import annotations

import io
import unicodedata
import zipfile
from pathlib import PurePath, PurePosixPath
from typing import TYPE_CHECKING

from autograder.grading.collecting.collected_files import CollectedRecords
from autograder.grading.collecting.submitted_file_names import read_lms_name
from autograder.grading.reporting.gradebook_layouts import LAYOUTS
from autograder.grading.reporting.lms_gradebooks import line_from_lms

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.reporting.class_table import ClassTable


def pages_for(
    directory: ClassDirectory, table: ClassTable, to: str, assignments: Sequence[str], notices: list[str]
) -> Iterator[tuple[str, bytes, str]]:
    """Yield a zip with the feedback pages of each assignment, as a name, the content and the purpose.

    Args:
        directory: The class.
        table: The table of the class.
        to: A system in :data:`LAYOUTS`; one that takes no pages gets none.
        assignments: The assignments.
        notices: Gets a sentence about students whose pages have no name in that system.
    """
    layout, records = LAYOUTS[to], CollectedRecords(directory.state)
    for assignment in assignments if layout.pages else ():
        data, unknown = _feedback_zip(directory, table, records, assignment, to)
        if data:
            purpose = f"{to.capitalize()}: the assignment {assignment}, {layout.pages}"
            yield f"feedback-{to}-{assignment}.zip", data, purpose
        if unknown:
            notices.append(
                f"the zip has no feedback on {assignment} for {', '.join(unknown)}: their work was not collected from "
                f"{to.capitalize()}, so the names that {to.capitalize()} gives to these pages are unknown"
            )


_MADE = (2000, 1, 1, 0, 0, 0)


def _feedback_zip(
    directory: ClassDirectory, table: ClassTable, records: CollectedRecords, assignment: str, lms: str
) -> tuple[bytes, list[str]]:
    """Return the feedback pages of one assignment as a zip, and the students whose page could not be included.

    Args:
        directory: The class.
        table: The table of the class.
        records: The records of what was collected.
        assignment: The assignment's name.
        lms: A system that takes feedback pages.

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
            there = line_from_lms(records, assignment, student, lms)
            if there is None:
                unknown.append(student)
                continue
            for page in pages:
                if lms == "moodle":
                    name = table.roster.students[student].name or student
                    plain = "".join(" " if character in "_/\\" else character for character in name)
                    folder = f"{unicodedata.normalize('NFC', plain)}_{there.number}_assignsubmission_file"
                    called = f"{folder}/{page.name}"
                else:
                    called = _page_name(there.file, lms, page, is_one=len(pages) == 1)
                # The zip contains no time of this machine, so the same class gives the same zip.
                archive.writestr(zipfile.ZipInfo(called, _MADE), page.read_bytes(), zipfile.ZIP_DEFLATED)
    return (data.getvalue() if archive.namelist() else b""), unknown


def _page_name(file: str, lms: str, page: PurePath, *, is_one: bool) -> str:
    """Return the name of a page in the zip, derived from the name that the LMS gave to the student's file or folder.

    If the student handed in a zip that was unpacked, use the folder's name, because the student chose the names in the
    zip.
    """
    parts = PurePosixPath(file).parts
    place, found = next(
        (place, found) for place in range(len(parts)) if (found := read_lms_name(parts, place, lms))
    )
    above, given = "".join(f"{one}/" for one in parts[:place]), parts[place]
    if lms == "canvas":
        return f"{PurePosixPath(given).stem}{'' if is_one else f'_{page.stem}'}.html"
    head = f"{given}/" if place < len(parts) - 1 else given.removesuffix(found.file)
    return f"{above}{head}{LAYOUTS[lms].within}{page.name}"
