"""Every notebook runs to its end: masters earn full marks, chapters nothing, and no traceback is seen."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from nbclient import NotebookClient

from autograder.masters.layout import masters
from autograder.masters.release import release_notebook
from autograder.masters.source import source_notebook

if TYPE_CHECKING:
    from nbformat import NotebookNode

ROOT = Path(__file__).resolve().parents[2]
each_master = pytest.mark.parametrize("master", masters(ROOT), ids=lambda path: path.stem)
CELL_LIMIT = 120
"""Seconds for one cell, after which the notebook counts as hanging."""


def run(notebook: NotebookNode, folder: Path) -> dict[str, tuple[float, float]]:
    """Execute a notebook in a folder; the score and the points of each check cell."""
    environment = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    client = NotebookClient(notebook, timeout=CELL_LIMIT, resources={"metadata": {"path": str(folder)}})
    client.execute(env=environment)
    scores = {}
    for cell in notebook.cells:
        data = cell.metadata.get("nbgrader", {})
        for output in cell.get("outputs", []):
            # nbgrader gives no points to a graded cell that writes to standard error.
            assert output.get("name") != "stderr", output.text
        if data.get("grade"):
            results = [output for output in cell.outputs if output.output_type == "execute_result"]
            scores[data["grade_id"]] = (float(results[-1].data["text/plain"]), float(data["points"]))
    return scores


@pytest.mark.ros
@pytest.mark.slow
@each_master
def test_a_master_earns_full_marks(master: Path, tmp_path: Path) -> None:
    scores = run(source_notebook(master), tmp_path)
    assert scores
    assert all(score == points for score, points in scores.values()), scores


@pytest.mark.ros
@pytest.mark.slow
@each_master
def test_a_chapter_runs_to_its_end_and_earns_nothing(master: Path, tmp_path: Path) -> None:
    # An exception in any cell would end this with a CellExecutionError.
    scores = run(release_notebook(source_notebook(master)), tmp_path)
    assert scores
    assert all(score == 0 for score, _ in scores.values()), scores
