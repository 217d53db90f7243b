"""The line of the student's that a traceback is about."""

from __future__ import annotations

import pytest

from autograder.cards.readable_text import TracebackLine, students_line
from tests.cases import named_cases


@pytest.mark.parametrize(
    ("detail", "advice", "shown"), named_cases(__file__, "the_line_of_the_students_that_a_traceback_is_about")
)
def test_the_line_of_the_students_that_a_traceback_is_about(
    detail: str, advice: str, shown: tuple[str, ...]
) -> None:
    assert students_line(detail, advice) == (TracebackLine(*shown) if shown else None)
