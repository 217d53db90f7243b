"""The class that is graded again and again."""

from __future__ import annotations

from autograder import course
from autograder.grading.new_classes.sample_class import BANK
from tests.measure.steady_class import STUDENTS


def test_each_file_that_a_student_hands_in_is_in_the_bank_of_notebooks() -> None:
    files = [file for handed_in in STUDENTS.values() for file in handed_in]
    assert [file for file in files if not (course.root() / BANK / file).is_file()] == []
