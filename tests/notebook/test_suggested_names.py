"""A typo in a name: the traceback of a check names what was meant, whichever Python runs the notebook."""

from __future__ import annotations

import pytest

from autograder.notebook.checking.subject_runs import student_traceback
from tests.cases import cases

CELL = cases(__file__, "CELL")


@pytest.mark.parametrize(("line", "end"), cases(__file__, "the_name_that_was_meant_is_said"))
def test_the_name_that_was_meant_is_said(line: str, end: str) -> None:
    names: dict[str, type] = {}
    exec(compile(CELL.format(line=line), "/tmp/ipykernel_7/123.py", "exec"), names)
    with pytest.raises(Exception) as caught:  # noqa: PT011
        names["Driver"]().drive()
    assert student_traceback(caught.value).endswith(end)
