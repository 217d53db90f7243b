"""What the grader puts right in a notebook is said to the student, in the terminal, and on the page about the class."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from nbformat.v4 import new_code_cell
from test_nbgrader_and_ours import nbgrader_autograde
from tiny_class import shown

from autograder.grading.reporting.grade_report import report_json
from autograder.grading.reporting.report_page import write_report

if TYPE_CHECKING:
    from tiny_class import TinyClass


pytestmark = pytest.mark.usefixtures("fake_engine")


def test_it_is_said_everywhere_also_when_nothing_has_changed_since(tiny: TinyClass) -> None:
    notebook = tiny.released()
    notebook.cells = [
        cell for cell in notebook.cells if cell.metadata.get("nbgrader", {}).get("grade_id") != "Talker"
    ]
    notebook.cells.append(new_code_cell("def Talker():\n    return 7"))
    tiny.submit("ada")
    tiny.hand_in("eve", notebook)
    words = "The cell `Talker` was missing. Another cell contains the answer, and that cell counts."
    for report in (tiny.grade(feedback=True), tiny.grade(feedback=True)):
        assert [line for line in shown(report).splitlines() if line.startswith("remark ")] == [
            f"remark       eve/lab_1_2: {words}"
        ]
        assert words in report_json(report).decode()
    page = (tiny.path / "feedback" / "eve" / "lab_1_2" / "lab_1_2.html").read_text()
    assert "Another cell contains the answer" in page
    assert "Another cell contains the answer" in write_report(tiny.path).read_text()
    assert "Another cell contains the answer" not in write_report(tiny.path, names=False).read_text()


def test_nbgraders_own_command_says_it_too(tiny: TinyClass, caplog: pytest.LogCaptureFixture) -> None:
    notebook = tiny.released()
    notebook.cells.pop()
    tiny.hand_in("eve", notebook)
    nbgrader_autograde(tiny)
    assert "eve/lab_1_2: The cell `lab_1_2-listener` was missing and put back." in caplog.text


def test_an_honest_notebook_has_no_line(tiny: TinyClass) -> None:
    tiny.submit("ada")
    assert "remark " not in shown(tiny.grade())
