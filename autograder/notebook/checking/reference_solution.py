"""The reference solution of an exercise, where this course has it to read: a hand-out has it only where asked for."""

from __future__ import annotations

import json

from autograder import course
from autograder.cards.solution import Solution


def solution_of(exercise: str) -> Solution | None:
    """The reference solution, for full marks; None where it is not there. A grader's box sees no course, and so none.

    Args:
        exercise: The exercise's id.
    """
    try:
        for chapter in course.chapters(course.root()):
            for lab in chapter.labs:
                if file := chapter.exercises_of(lab).get(exercise):
                    said = json.loads(file.with_suffix(course.SOLUTION).read_text(encoding="utf-8"))
                    return Solution(tuple(said["code"]), said["why"], said["other_way"], said["other_code"])
    except (OSError, ValueError, KeyError, TypeError, course.NoCourse, course.BrokenChapter):
        pass  # an offer beside a check, which nothing may break
    return None
