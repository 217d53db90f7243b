"""A program repeats what the notebook has defined, and a master says so in one line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import nbformat
import pytest

from autograder.masters.master_files import MasterError
from autograder.masters.notebook_release import release_text
from autograder.masters.source_notebooks import Points, source_notebook
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

MASTER = cases(__file__, "MASTER")


def test_the_master_writes_the_whole_program(write_master: Callable[[str], Path], ten_points: Points) -> None:
    source = source_notebook(write_master(MASTER), points=ten_points)
    assert source.cells[3].source.split("\n") == [
        "%%writefile double.py",
        "LIMIT = 3",
        "",
        "",
        "### BEGIN SOLUTION",
        "# TODO: copy double to this place.",
        "def double(number: int) -> int:",
        '    """Twice the number."""',
        "    return 2 * number",
        "### END SOLUTION",
        "",
        "",
        "print(double(LIMIT))",
    ]
    given = nbformat.reads(release_text(source), as_version=4).cells[3].source
    assert "LIMIT = 3\n\n\n# TODO: copy double to this place.\n\n\nprint" in given


def test_a_decorator_is_copied_with_what_it_decorates(
    write_master: Callable[[str], Path], ten_points: Points
) -> None:
    master = write_master(
        MASTER.replace("def double(number: int) -> int:", "@cache\ndef double(number: int) -> int:")
    )
    assert "@cache\ndef double" in source_notebook(master, points=ten_points).cells[3].source


def test_what_is_not_defined_above_cannot_be_copied(
    write_master: Callable[[str], Path], ten_points: Points
) -> None:
    master = write_master(MASTER.replace("### COPY double", "### COPY triple"))
    with pytest.raises(MasterError, match=r"'triple', which no cell above defines.*LIMIT, double") as refused:
        source_notebook(master, points=ten_points)
    assert master.read_text().splitlines()[(refused.value.line or 0) - 1] == "### COPY triple"
