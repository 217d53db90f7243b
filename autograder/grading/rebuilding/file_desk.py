"""The desk of a grading process, which reads the files of students.

Each request is carried out by a process of its own in the desk's box (:mod:`autograder.boxes.reading_desks`).
"""

from __future__ import annotations

from autograder.boxes.reading_desks import KeptDesk

READERS = {
    "submission": "autograder.grading.rebuilding.notebook_parsing",
    "archive": "autograder.grading.collecting.archive_unpacking",
    "list": "autograder.grading.collecting.lms_lists",
}
"""For each request, the module that reads. The grading process itself calls none of these readers."""

desk = KeptDesk(READERS)
