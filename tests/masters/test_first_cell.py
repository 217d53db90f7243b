"""The cells with which a notebook is opened elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.masters.source_notebooks import SET_UP_CELL, SET_UP_CODE, Points, source_notebook

if TYPE_CHECKING:
    from pathlib import Path


def test_a_course_with_its_own_set_up_gets_the_cell_and_with_an_address_the_links(
    course: Path, ten_points: Points
) -> None:
    master = course / "solutions/01_first/lab_9_1/lab.md"
    assert SET_UP_CELL not in [cell.id for cell in source_notebook(master, points=ten_points).cells]
    (course / SET_UP_CODE).parent.mkdir()
    (course / SET_UP_CODE).touch()
    without = source_notebook(master, points=ten_points)
    assert next(cell.id for cell in without.cells if cell.cell_type == "code") == SET_UP_CELL
    assert "codespaces" not in str(without)
    (course / "pyproject.toml").write_text('[project.urls]\nRepository = "https://github.com/ada/ros"\n')
    text = str(source_notebook(master, points=ten_points))
    path = "chapters/01_first/lab_9_1.ipynb"
    assert f"https://colab.research.google.com/github/ada/ros/blob/main/{path}" in text
    assert "https://codespaces.new/ada/ros" in text
    assert f"https://mybinder.org/v2/gh/ada/ros/main?urlpath=lab/tree/{path}" in text
    assert "https://github.com/ada/ros/archive/refs/heads/main.zip" in text
