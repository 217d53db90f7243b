"""Whose code a file is: tracebacks keep a student's lines and drop everybody else's."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
import rclpy.executors

import autograder.notebook
from autograder.notebook.cell_output import is_students

PACKAGE = Path(autograder.notebook.__file__).parent


def test_no_file_of_the_notebooks_package_is_the_students() -> None:
    files = sorted(PACKAGE.rglob("*.py"))
    assert {file.parent.name for file in files} > {"notebook", "nodes", "checking"}
    assert not [file for file in files if is_students(str(file))]


@pytest.mark.parametrize(
    "file", [rclpy.executors.__file__, threading.__file__, "<frozen importlib._bootstrap>"]
)
def test_rclpy_and_python_are_not_either(file: str) -> None:
    assert not is_students(file)


@pytest.mark.parametrize("file", ["/tmp/ipykernel_7/123.py", "/home/ada/ros2_ws/src/my_package/talker.py"])
def test_a_cell_and_a_program_of_a_workspace_are(file: str) -> None:
    assert is_students(file)
