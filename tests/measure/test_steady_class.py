"""The class that is graded again and again."""

from __future__ import annotations

from autograder import course
from tests.measure.steady_class import STUDENTS
from tests.submissions.odd_notebooks import BANK


def test_each_file_that_a_student_hands_in_is_in_the_bank_of_notebooks() -> None:
    files = [file for handed_in in STUDENTS.values() for file in handed_in]
    assert [file for file in files if not (course.root() / BANK / file).is_file()] == []
