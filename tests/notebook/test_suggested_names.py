"""A typo in a name: the traceback of a check names what was meant, whichever Python runs the notebook."""

from __future__ import annotations

import pytest

from autograder.notebook.checking.subject_runs import student_traceback

CELL = """
class Driver:
    def __init__(self):
        self.publisher = print

    def drive(self):
        command = 1
        {line}
"""


@pytest.mark.parametrize(
    ("line", "end"),
    [
        ("self.publisher(comand)", "name 'comand' is not defined. Did you mean: 'command'?"),
        ("sefl.publisher(command)", "name 'sefl' is not defined. Did you mean: 'self'?"),
        ("publisher(command)", "name 'publisher' is not defined. Did you mean: 'self.publisher'?"),
        ("self.publsher(command)", "object has no attribute 'publsher'. Did you mean: 'publisher'?"),
        ("self.DRIVE()", "object has no attribute 'DRIVE'. Did you mean: 'drive'?"),
        ("raise TimeOutError", "name 'TimeOutError' is not defined. Did you mean: 'TimeoutError'?"),
        ("chatter", "name 'chatter' is not defined"),
        ("self.publisher[command]", "is not subscriptable"),
        ("raise AttributeError('nothing')", "AttributeError: nothing"),
    ],
)
def test_the_name_that_was_meant_is_said(line: str, end: str) -> None:
    names: dict[str, type] = {}
    exec(compile(CELL.format(line=line), "/tmp/ipykernel_7/123.py", "exec"), names)
    with pytest.raises(Exception) as caught:  # noqa: PT011
        names["Driver"]().drive()
    assert student_traceback(caught.value).endswith(end)
