"""nbgrader's Validate in a process of its own: it says which cell runs, and then what nbgrader says."""

from __future__ import annotations

import json
import subprocess
from typing import TYPE_CHECKING

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from pathlib import Path

GRADED = {
    "grade": True, "grade_id": "a_test", "locked": True, "points": 1, "schema_version": 3, "solution": False,
    "task": False, "cell_type": "code",
}  # fmt: skip


def lines(folder: Path, notebook: str) -> list[dict[str, object]]:
    command = python_child("-m", "autograder.student.validation", str(folder), notebook).command
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.slow
def test_each_cell_is_told_and_at_the_end_what_nbgrader_says(tmp_path: Path) -> None:
    graded = new_code_cell("assert x == 2", metadata={"nbgrader": GRADED})
    cells = [new_markdown_cell("A task"), new_code_cell("print('printed by the kernel'); x = 1"), graded]
    (tmp_path / "labs").mkdir()
    nbformat.write(new_notebook(cells=cells), tmp_path / "labs" / "lab.ipynb")
    *progress, last = lines(tmp_path, "labs/lab.ipynb")
    assert progress == [{"at": 1}, {"at": 2}, {"at": 3}]
    answer = last["answer"]
    assert isinstance(answer, dict)
    assert answer["success"]
    assert "AssertionError" in answer["value"]["failed"][0]["error"]


@pytest.mark.slow
def test_a_notebook_that_is_missing_is_an_answer_too(tmp_path: Path) -> None:
    (last,) = lines(tmp_path, "nothing.ipynb")
    answer = last["answer"]
    assert isinstance(answer, dict)
    assert not answer["success"]
