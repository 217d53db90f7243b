"""The cells with which a notebook is opened elsewhere."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from autograder.masters.source_notebooks import SET_UP_CELL, SET_UP_CODE, Points, source_notebook
from tests.cases import cases

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


@pytest.mark.parametrize(
    ("archive", "said"), cases(__file__, "outside_of_the_course_the_cell_says_what_is_missing")
)
def test_outside_of_the_course_the_cell_says_what_is_missing(
    course: Path, ten_points: Points, tmp_path_factory: pytest.TempPathFactory, archive: str, said: str
) -> None:
    (course / SET_UP_CODE).parent.mkdir()
    (course / SET_UP_CODE).touch()
    notebook = source_notebook(course / "solutions/01_first/lab_9_1/lab.md", points=ten_points)
    cell = next(cell for cell in notebook.cells if cell.id == SET_UP_CELL)
    # -S: without the packages of this environment, among them the course.
    done = subprocess.run(
        [sys.executable, "-S", "-c", cell.source],
        cwd=tmp_path_factory.mktemp("elsewhere"),
        env={"ROS2_COURSE_ARCHIVE": archive},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, said in done.stderr.splitlines()[-1]) == (1, True), done.stderr
