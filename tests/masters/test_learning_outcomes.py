"""The page of learning outcomes names tasks that exist, and leaves out no exercise."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest

from autograder import exercises

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "learning-outcomes.md"
ROWS = re.findall(
    r"^\| (.+) \| \[`([\w.]+)`\]\(\.\./(chapters/\S+\.ipynb)\) \|$",
    PAGE.read_text(encoding="utf-8"),
    flags=re.MULTILINE,
)


def tasks(notebook: Path) -> set[str]:
    """The names of the cells that students write in a notebook, and its exercises."""
    named = {
        cell.metadata.nbgrader.grade_id
        for cell in nbformat.read(notebook, as_version=4).cells
        if cell.metadata.get("nbgrader", {}).get("solution", False)
    }
    return named | {one for one in exercises.all_ids() if exercises.path(one).parent.name == notebook.stem}


def test_the_table_is_read() -> None:
    lines = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    assert (
        len(ROWS) == len(lines) - 2 * 2
    )  # without the heading of each chapter's table and the line below it


@pytest.mark.parametrize(("outcome", "task", "notebook"), ROWS)
def test_each_outcome_is_shown_by_a_task_of_its_notebook(outcome: str, task: str, notebook: str) -> None:
    assert task in tasks(ROOT / notebook), outcome


def test_every_exercise_shows_an_outcome() -> None:
    """What a ticket of a bug hunt teaches would tell its cause, so one of its exercises stands for the notebook."""
    shown = {task for _, task, _ in ROWS}
    hunts = {one.id for one in exercises.unbroken() if one.hides_causes}
    assert set(exercises.all_ids()) - hunts <= shown
    assert {one.partition(".")[0] for one in hunts} <= {one.partition(".")[0] for one in shown & hunts}
