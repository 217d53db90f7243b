"""The notebooks of a build are byte for byte those of nbgrader's own commands."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbgrader.api import Gradebook
from nbgrader.apps import NbGraderAPI
from traitlets.config import Config

from autograder.masters.master_files import chapter_path, lab_name, masters
from autograder.masters.release_steps import ReleaseSteps
from autograder.masters.source_notebooks import source_notebook

ROOT = Path(__file__).resolve().parents[2]
MASTERS = masters(ROOT)
CONFIG = """\
c = get_config()
from autograder.masters.release_steps import ReleaseSteps
c.GenerateAssignment.preprocessors = ReleaseSteps()
"""


@pytest.fixture
def nbgrader_class(tmp_path: Path) -> Path:
    """A class with the source notebooks of the course in it."""
    for master in MASTERS:
        source = tmp_path / "source" / lab_name(master) / f"{lab_name(master)}.ipynb"
        source.parent.mkdir(parents=True)
        nbformat.write(source_notebook(master), source)
    return tmp_path


def released(folder: Path, master: Path) -> bytes:
    return (folder / "release" / lab_name(master) / f"{lab_name(master)}.ipynb").read_bytes()


@pytest.mark.slow
def test_the_command_gives_the_same_bytes(nbgrader_class: Path) -> None:
    (nbgrader_class / "nbgrader_config.py").write_text(CONFIG)
    master = ROOT / "solutions" / "01_ros2_fundamentals" / "lab_1_2" / "lab.md"
    subprocess.run(
        [sys.executable, "-m", "nbgrader", "generate_assignment", lab_name(master)],
        cwd=nbgrader_class,
        check=True,
        capture_output=True,
        text=True,
    )
    assert released(nbgrader_class, master) == chapter_path(ROOT, master).read_bytes()


def test_the_formgrader_gives_the_same_bytes(nbgrader_class: Path) -> None:
    config = Config()
    config.CourseDirectory.root = str(nbgrader_class)
    config.CourseDirectory.db_url = f"sqlite:///{nbgrader_class / 'gradebook.db'}"
    config.GenerateAssignment.preprocessors = ReleaseSteps()
    api = NbGraderAPI(config=config)
    for master in MASTERS:
        result = api.generate_assignment(lab_name(master))
        assert result["success"], result
        assert released(nbgrader_class, master) == chapter_path(ROOT, master).read_bytes()
    with Gradebook(config.CourseDirectory.db_url) as gradebook:
        cells = gradebook.find_notebook("lab_1_2", "lab_1_2").grade_cells
        assert {cell.name for cell in cells} == {
            f"lab_1_2-{name}" for name in ("talker", "listener", "wall", "rooms", "programs")
        }
        assert all(cell.max_score > 0 for cell in cells)


def test_without_the_configuration_the_bytes_differ(nbgrader_class: Path) -> None:
    """The comparison above can fail: stock nbgrader puts its own text into every solution."""
    config = Config()
    config.CourseDirectory.root = str(nbgrader_class)
    config.CourseDirectory.db_url = f"sqlite:///{nbgrader_class / 'gradebook.db'}"
    assert NbGraderAPI(config=config).generate_assignment("lab_1_2")["success"]
    theirs = released(nbgrader_class, Path("lab_1_2/lab.md"))
    assert b"YOUR CODE HERE" in theirs
    assert b"create_timer(0.5" not in theirs
