"""Cells that write files or run in a shell."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

import nbformat
import pytest

from autograder.masters.code_cells import WrittenFile, find_region, python_of, shell_script, written_file
from autograder.masters.notebook_release import release_text
from autograder.masters.reference_solutions import reference_source
from autograder.masters.source_notebooks import Points, source_notebook
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

MASTER = cases(__file__, "MASTER")


@pytest.fixture
def master(write_master: Callable[[str], Path]) -> Path:
    return write_master(MASTER)


def test_in_xml_each_mark_is_a_comment_of_its_own() -> None:
    region = find_region(
        "<package>\n  <!-- ### BEGIN SOLUTION -->\n  <!-- # TODO: write the name. -->\n  <name>one</name>\n"
        "  <!-- ### END SOLUTION -->\n</package>"
    )
    assert region.unsolved == "<package>\n  <!-- # TODO: write the name. -->\n</package>"
    assert region.answer == ("  <name>one</name>",)


def test_the_magic_stays_on_the_first_line(master: Path, ten_points: Points) -> None:
    chapter = nbformat.reads(release_text(source_notebook(master, points=ten_points)), as_version=4)
    sources = {cell.id: cell.source for cell in chapter.cells}
    assert sources["hello_py"].split("\n") == [
        "%%writefile made/hello.py",
        'TEXT = "it\'s here"',
        "# TODO: print the text.",
    ]
    assert sources["launch_file"].endswith("launch:\n  # TODO: start it.")
    assert sources["lab_9_1-hello"] == 'check("lab_9_1.hello", "made")'


def test_the_reference_makes_the_files(master: Path, ten_points: Points, tmp_path: Path) -> None:
    reference = reference_source(master, "lab_9_1.hello", points=ten_points)
    assert reference.subject == "'made'"
    subprocess.run([sys.executable, "-c", reference.source], cwd=tmp_path, check=True)
    assert (tmp_path / "made/log").read_text() == "shell\n"
    hello = subprocess.run([sys.executable, tmp_path / "made/hello.py"], capture_output=True, text=True)
    assert hello.stdout == "it's here\n"
    assert "node: {pkg: a, exec: b}" in (tmp_path / "made/launch.yaml").read_text()


def test_a_definition_needs_no_shell(write_master: Callable[[str], Path], ten_points: Points) -> None:
    text = MASTER.replace('check("lab_9_1.hello", "made")', 'check("lab_9_1.hello", hello)').replace(
        "%%writefile made/hello.py\n", "def hello(): ...\n"
    )
    reference = reference_source(write_master(text), "lab_9_1.hello", points=ten_points)
    assert "subprocess" not in reference.source


def test_what_a_cell_writes() -> None:
    source = "%%writefile  'my ws/setup.py' \nimport os\n"
    assert written_file(source) == WrittenFile(PurePosixPath("my ws/setup.py"), "import os\n")
    assert written_file("%%bash\ncat > setup.py") is None
    assert written_file("print(1)\n%%writefile late.py") is None
    # With an option (-a appends) the file is not what the cell says.
    assert written_file("%%writefile -a setup.py\n1") is None


def test_what_a_cell_gives_to_the_shell() -> None:
    assert shell_script("%%bash --no-raise-error\nls\npwd") == "ls\npwd"
    assert shell_script("%%writefile bash\nls") is None
    assert shell_script("!ls") is None


def test_errors_name_the_line_of_the_cell() -> None:
    assert python_of("%%writefile a.py\nx = 1") == "\nx = 1"
    assert python_of("%%writefile a.yaml\nx: [") == ""
    assert python_of("x = 1") == "x = 1"


@pytest.mark.parametrize(
    ("region", "unsolved"),
    [
        (
            "# TODO: repair it.\n#- class A:\n#-     one = 2\n#-\n#- A()\nclass A:\n    one = 1\n\nA()",
            "# TODO: repair it.\nclass A:\n    one = 2\n\nA()",
        ),
        ("    # TODO: repair it.\n    #- one = 2\n    one = 1", "    # TODO: repair it.\n    one = 2"),
        (
            '<!-- # TODO: repair it. -->\n<!-- #- <node exec="b"/> -->\n<node exec="a"/>',
            '<!-- # TODO: repair it. -->\n<node exec="b"/>',
        ),
    ],
    ids=["a whole program", "lines", "XML"],
)
def test_students_get_broken_code_that_stands_in_comments(region: str, unsolved: str) -> None:
    xml = "<" in region
    begin, end = (
        f"<!-- ### {word} SOLUTION -->" if xml else f"### {word} SOLUTION" for word in ("BEGIN", "END")
    )
    found = find_region(f"{begin}\n{region}\n{end}")
    assert found.unsolved == unsolved
    assert "TODO" not in found.solved
    assert "#-" not in found.solved
