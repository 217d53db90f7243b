"""A broken notebook of the course is seen, named and kept with its outputs."""

from __future__ import annotations

from io import StringIO
from typing import TYPE_CHECKING

import nbformat
import pytest
from rich.console import Console

from autograder.authoring.notebook_execution import NothingToExecuteError, execute_command
from autograder.masters.chapter_building import build
from autograder.masters.master_cells import MASTER_HEADER
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

GOOD = cases(__file__, "GOOD")
DIVIDES = """
What is one divided by it?

```{code-cell} ipython3
1 / double(2)
```
"""
"""With the solution it works; the stub returns 0, and the cell below it does not cope with that."""
SHOWS_A_TRACEBACK = cases(__file__, "SHOWS_A_TRACEBACK")
WRITES_TO_STANDARD_ERROR = """
Complain:

```{code-cell} ipython3
import sys
print("oh", file=sys.stderr)
```
"""


def course(folder: Path, text: str) -> Path:
    """A course with one notebook."""
    master = folder / "solutions" / "01_first" / "lab_9_1" / "lab.md"
    master.parent.mkdir(parents=True)
    master.write_text(f"{MASTER_HEADER}\n{text}")
    build(folder)
    return folder


def execute(root: Path, **options: object) -> tuple[int, str]:
    """The exit code, and what a person sees."""
    console = Console(file=StringIO(), width=200)
    code = execute_command(root, jobs=2, console=console, **options)  # type: ignore[arg-type]
    return code, console.file.getvalue()  # type: ignore[attr-defined]


def test_a_good_notebook_passes_as_master_and_as_chapter(tmp_path: Path) -> None:
    code, seen = execute(course(tmp_path, GOOD))
    assert code == 0, seen
    assert "2 notebooks executed, 0 failed" in seen
    assert not (tmp_path / "execution-reports").exists()


def test_a_cell_that_does_not_cope_with_the_stub_is_found_in_the_chapter(tmp_path: Path) -> None:
    code, seen = execute(course(tmp_path, GOOD + DIVIDES))
    assert code == 1
    assert "2 notebooks executed, 1 failed" in seen
    assert "chapter lab_9_1 failed" in seen
    # Three cells of text and two of code stand before it.
    assert "cell 6 raised ZeroDivisionError: division by zero" in seen
    report = tmp_path / "execution-reports" / "lab_9_1-chapter.ipynb"
    assert [*report.parent.iterdir()] == [report]
    assert nbformat.read(report, as_version=4).cells[5].outputs[0].ename == "ZeroDivisionError"


def test_the_notebooks_of_an_earlier_run_go_away_and_no_others(tmp_path: Path) -> None:
    course(tmp_path, GOOD)
    old, other = (tmp_path / "execution-reports" / name for name in ("lab_9_1-master.ipynb", "mine.ipynb"))
    old.parent.mkdir()
    for file in (old, other):
        file.write_text("old")
    assert execute(tmp_path)[0] == 0
    assert [*old.parent.iterdir()] == [other]


@pytest.mark.parametrize(
    ("text", "words"),
    [(SHOWS_A_TRACEBACK, "shows a stray traceback"), (WRITES_TO_STANDARD_ERROR, "writes to standard error")],
)
def test_what_would_alarm_a_student_is_found(text: str, words: str, tmp_path: Path) -> None:
    code, seen = execute(course(tmp_path, GOOD + text))
    assert code == 1
    assert seen.count(words) == 2, seen


def test_an_unknown_name_is_refused(tmp_path: Path) -> None:
    with pytest.raises(NothingToExecuteError, match="no notebook is named 'lab_7'"):
        execute(course(tmp_path, GOOD), only=["lab_7"])


def test_a_chapter_that_was_never_built_is_named(tmp_path: Path) -> None:
    (course(tmp_path, GOOD) / "chapters" / "01_first" / "lab_9_1.ipynb").unlink()
    with pytest.raises(NothingToExecuteError, match=r"\./course build"):
        execute(tmp_path)


def test_a_chapter_that_is_no_notebook_is_named(tmp_path: Path) -> None:
    root = course(tmp_path, GOOD)
    (notebook,) = (root / "chapters").rglob("*.ipynb")
    notebook.write_text("<<<<<<< HEAD")
    with pytest.raises(NothingToExecuteError, match=r"is not a notebook: run `\./course build`"):
        execute(root)
