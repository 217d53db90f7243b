"""*Restart and Run All*, as often as one likes and in any order, leaves the workspace as it was."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from autograder.masters.code_cells import shell_script, written_file
from autograder.masters.master_cells import CellRole
from autograder.masters.master_files import lab_name, masters
from autograder.masters.notebook_release import release_text
from autograder.masters.source_notebooks import source_notebook

ROOT = Path(__file__).resolve().parents[2]
CHANGES = re.compile(
    r"^print\((add_entry_points|add_dependencies|add_definition|complete_package)\(", re.MULTILINE
)
MAKES = re.compile(r"^\s*(mkdir|ros2 pkg create)\b", re.MULTILINE)
IMPORTS = (
    "import pathlib, subprocess\n"
    "from autograder.notebook.package_files import add_data_files, add_definition, add_dependencies\n"
    "from autograder.notebook.package_files import add_entry_points\n"
    "from autograder.notebook.robot_package import complete_package\n"
)


def steps(master: Path, *, solved: bool) -> str:
    """A program that does to the files what the notebook does: all but builds, programs and nodes."""
    notebook = source_notebook(master)
    notebook = notebook if solved else nbformat.reads(release_text(notebook), as_version=4)
    parts = [IMPORTS]
    for cell in notebook.cells:
        if cell.cell_type == CellRole.TEXT or cell.cell_type == "markdown":
            continue
        file, script = written_file(cell.source), shell_script(cell.source)
        if file is not None:
            parts.append(f"pathlib.Path({str(file.path)!r}).write_text({file.text!r})")
        elif script is not None and MAKES.search(script):
            parts.append(f"subprocess.run(['bash', '-c', {script!r}], check=False)")
        elif CHANGES.search(cell.source):
            parts.append(cell.source)
    return "\n".join(parts)


def files(folder: Path) -> dict[str, str]:
    found = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.suffix != ".pyc")
    return {str(path.relative_to(folder)): path.read_text() for path in found}


def test_the_files_of_the_notebooks_are_seen() -> None:
    programs = [steps(master, solved=True) for master in masters(ROOT)]
    assert sum(program.count("write_text") for program in programs) >= 15
    assert sum(program.count("add_entry_points(") for program in programs) >= 6


@pytest.mark.slow
@pytest.mark.parametrize("solved", [True, False], ids=["solved", "unsolved"])
def test_running_all_again_leaves_the_same_workspace(tmp_path: Path, solved: bool) -> None:
    programs = {lab_name(master): steps(master, solved=solved) for master in masters(ROOT)}

    def run(names: list[str]) -> dict[str, str]:
        for name in names:
            done = subprocess.run(
                [sys.executable, "-c", programs[name]],
                cwd=tmp_path,
                capture_output=True,
                text=True,
                check=False,
            )
            assert done.returncode == 0, (name, done.stderr)
        return files(tmp_path)

    whole = run(list(programs))
    setup = whole["ros2_ws/src/my_robot_pkg/setup.py"]
    # Unsolved, the two that Exercise 1.1 needs are put there for the student.
    assert setup.count(":main") == (9 if solved else 2)
    assert ("Fibonacci.action" in whole["ros2_ws/src/my_robot_interfaces/CMakeLists.txt"]) is solved
    for _ in range(2):
        assert run(list(programs)) == whole
    if not solved:  # whoever has no talker gets the course's in Exercise 1.1, until Lab 1.2 writes theirs
        return
    mixed = random.Random(2)
    for _ in range(2):
        assert run(mixed.sample(list(programs), len(programs))) == whole
    for name in programs:
        assert run([name]) == whole, name
