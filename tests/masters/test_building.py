"""Building the chapters: what is written, what is left alone, what is reported."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable
from typing import TYPE_CHECKING

import nbformat
import pytest
from nbformat import NotebookNode
from rich.console import Console

from autograder.masters.chapter_building import build, build_command
from autograder.masters.master_files import MasterError

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.masters.source_notebooks import Points

Said = Callable[..., tuple[int, str]]
CHAPTER = "chapters/01_first/lab_9_1.ipynb"


@pytest.fixture
def built(course: Path, ten_points: Points) -> Path:
    build(course, points=ten_points)
    return course


def edit(path: Path, change: Callable[[NotebookNode], None]) -> None:
    notebook = nbformat.read(path, as_version=4)
    change(notebook)
    nbformat.write(notebook, path)


def cell(notebook: NotebookNode, name: str) -> NotebookNode:
    return next(cell for cell in notebook.cells if cell.id == name)


def test_a_chapter_is_written_once(course: Path, ten_points: Points) -> None:
    first = build(course, points=ten_points)
    assert first.written == (course / CHAPTER,)
    text = (course / CHAPTER).read_bytes()
    second = build(course, points=ten_points)
    assert (second.written, second.unchanged) == ((), (course / CHAPTER,))
    assert (course / CHAPTER).read_bytes() == text
    assert second.in_step


def test_the_solution_is_gone_and_the_stub_runs(built: Path) -> None:
    notebook = nbformat.read(built / CHAPTER, as_version=4)
    assert "2 * number" not in (built / CHAPTER).read_text()
    source = cell(notebook, "double").source
    assert source.split("\n") == [
        "def double(number: int) -> int:",
        '    """Twice the number."""',
        "    # TODO: return twice the number.",
    ]
    namespace: dict[str, object] = {}
    exec(source, namespace)
    assert namespace["double"](21) is None  # type: ignore[operator]


def test_given_cells_are_locked_and_solutions_are_not(built: Path) -> None:
    notebook = nbformat.read(built / CHAPTER, as_version=4)
    editable = {c.id: c.metadata.get("editable", True) for c in notebook.cells if c.cell_type == "code"}
    assert editable == {
        "given-given": False,
        "double": True,
        "given-write-it": False,
        "lab_9_1-double": False,
    }
    assert all(c.metadata.deletable is False for c in notebook.cells if c.cell_type == "code")


def test_check_mode_writes_nothing_and_names_what_is_missing(course: Path, ten_points: Points) -> None:
    report = build(course, check=True, points=ten_points)
    assert report.stale == (course / CHAPTER,)
    assert not (course / "chapters").exists()


def test_check_mode_sees_a_changed_master(built: Path, ten_points: Points) -> None:
    master = built / "solutions/01_first/lab_9_1/lab.md"
    master.write_text(master.read_text().replace("Some text.", "Some other text."))
    before = (built / CHAPTER).read_bytes()
    report = build(built, check=True, points=ten_points)
    assert (report.stale, report.in_step) == ((built / CHAPTER,), False)
    assert (built / CHAPTER).read_bytes() == before
    assert build(built, points=ten_points).written == (built / CHAPTER,)
    assert build(built, check=True, points=ten_points).in_step


def test_check_mode_sees_one_changed_byte_of_a_chapter(built: Path, ten_points: Points) -> None:
    text = (built / CHAPTER).read_text()
    (built / CHAPTER).write_text(text.replace("Some text.", "Some texT."))
    assert build(built, check=True, points=ten_points).stale == (built / CHAPTER,)


def test_an_orphan_is_reported_and_kept(built: Path, ten_points: Points) -> None:
    orphan = built / "chapters/01_first/lab_9_2.ipynb"
    orphan.write_text("{}")
    hidden = built / "chapters/01_first/.ipynb_checkpoints/lab_9_1-checkpoint.ipynb"
    hidden.parent.mkdir()
    hidden.write_text("{}")
    for check in (True, False):
        report = build(built, check=check, points=ten_points)
        assert (report.orphans, report.in_step) == ((orphan,), False)
    assert orphan.exists()


def test_one_bad_master_changes_nothing(built: Path, ten_points: Points) -> None:
    good = built / "solutions/01_first/lab_9_1/lab.md"
    good.write_text(good.read_text().replace("Some text.", "Some other text."))
    (built / "solutions/01_first/lab_9_2").mkdir()
    (built / "solutions/01_first/lab_9_2/lab.md").write_text(
        "```{code-cell} ipython3\n:tags: [wrong]\n\nx\n```\n"
    )
    before = (built / CHAPTER).read_bytes()
    with pytest.raises(MasterError, match="Unknown tag 'wrong'"):
        build(built, points=ten_points)
    assert (built / CHAPTER).read_bytes() == before


def write_a_solution(notebook: NotebookNode) -> None:
    cell(notebook, "double").source += "\n    return number + number"


def add_a_cell(notebook: NotebookNode) -> None:
    notebook.cells.append(nbformat.v4.new_code_cell("print('mine')"))


def run_a_cell(notebook: NotebookNode) -> None:
    cell(notebook, "given-write-it").outputs = [nbformat.v4.new_output("stream", text="None\n")]


def take_notes(notebook: NotebookNode) -> None:
    notebook.cells[0].source += "\n\nmy notes"


@pytest.mark.parametrize("work", [write_a_solution, add_a_cell])
def test_work_in_a_chapter_is_never_overwritten(
    work: Callable[[NotebookNode], None], built: Path, ten_points: Points
) -> None:
    edit(built / CHAPTER, work)
    before = (built / CHAPTER).read_bytes()
    report = build(built, points=ten_points)
    assert (report.edited, report.in_step) == ((built / CHAPTER,), False)
    assert (built / CHAPTER).read_bytes() == before


@pytest.mark.parametrize("broken", ["", "{}", "no json", '{"cells": 3}'])
def test_a_file_that_is_no_notebook_is_never_overwritten(
    broken: str, built: Path, ten_points: Points
) -> None:
    (built / CHAPTER).write_text(broken)
    report = build(built, points=ten_points)
    assert report.edited == (built / CHAPTER,)
    assert (built / CHAPTER).read_text() == broken


def test_a_notebook_that_was_only_run_is_rebuilt(built: Path, ten_points: Points) -> None:
    edit(built / CHAPTER, run_a_cell)
    assert build(built, points=ten_points).written == (built / CHAPTER,)


@pytest.fixture
def said(ten_points: Points) -> Said:
    """Run the command; its exit code and what it said."""

    def run(root: Path, *, check: bool = False) -> tuple[int, str]:
        stream = io.StringIO()
        code = build_command(root, check=check, console=Console(width=200, file=stream), points=ten_points)
        return code, stream.getvalue()

    return run


def test_the_command_says_what_it_did(course: Path, said: Said) -> None:
    code, text = said(course)
    assert code == 0
    assert re.search(rf"written\s+{CHAPTER}", text)
    assert "1 chapter notebook up to date with the masters" in text


def test_the_command_fails_when_a_chapter_is_stale(course: Path, said: Said) -> None:
    code, text = said(course, check=True)
    assert code == 1
    assert re.search(rf"stale\s+{CHAPTER}.*\./course build", text)


def test_the_command_fails_with_2_when_a_master_cannot_be_used(course: Path, said: Said) -> None:
    (course / "solutions/01_first/lab_9_2").mkdir()
    (course / "solutions/01_first/lab_9_2/lab.md").write_text(
        "```{code-cell} ipython3\n:tags: [wrong]\n\nx\n```\n"
    )
    code, text = said(course)
    assert code == 2
    assert "lab_9_2/lab.md:1: Unknown tag 'wrong'. Known are: given, demonstration, solution, check." in text


def test_the_command_fails_with_2_outside_a_course(tmp_path: Path, said: Said) -> None:
    code, text = said(tmp_path)
    assert code == 2
    assert "Name the folder that holds" in text


def test_a_notebook_is_plain_json_with_a_last_newline(built: Path) -> None:
    text = (built / CHAPTER).read_text()
    assert text.endswith("}\n")
    assert json.loads(text)["nbformat"] == 4
