"""The course's own masters and chapters."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbgrader.nbgraderformat.v3 import MetadataValidatorV3

from autograder import exercises
from autograder.authoring.exercise_faults import broken_rules
from autograder.masters.chapter_building import build
from autograder.masters.code_cells import COPIED, find_region
from autograder.masters.master_cells import COPY_LINE, CellRole, parse_master
from autograder.masters.master_files import chapter_path, lab_name, masters
from autograder.masters.notebook_release import release_text
from autograder.masters.source_notebooks import named_cells, source_notebook
from tests.tiers import drawn

ROOT = Path(__file__).resolve().parents[2]
MASTERS = masters(ROOT)
each_master = pytest.mark.parametrize("master", MASTERS, ids=lab_name)


def test_every_chapter_is_in_step_with_its_master() -> None:
    report = build(ROOT, check=True)
    assert (report.stale, report.orphans) == ((), ())
    notebooks = [path for path in report.unchanged if path.suffix == ".ipynb"]
    assert len(notebooks) == len(MASTERS) >= 3


def test_another_process_builds_the_same_bytes() -> None:
    few = [master for master in MASTERS if str(master) in drawn(map(str, MASTERS), 3)]
    # Another hash seed, another folder: nothing of either may be in a chapter.
    code = (
        "import sys; from pathlib import Path; from autograder.masters.notebook_release import release_text\n"
        "from autograder.masters.source_notebooks import source_notebook\n"
        "for master in sys.argv[1:]: sys.stdout.write(release_text(source_notebook(Path(master))))"
    )
    result = subprocess.run(
        [sys.executable, "-c", code, *map(str, few)],
        cwd=ROOT.parent,
        env={**os.environ, "PYTHONHASHSEED": "7", "PYTHONIOENCODING": "utf-8"},
        capture_output=True,
        check=True,
    )
    assert result.stdout.decode() == "".join(chapter_path(ROOT, master).read_text() for master in few)


@each_master
def test_no_line_of_a_solution_is_in_its_chapter(master: Path) -> None:
    text = chapter_path(ROOT, master).read_text()
    notebook = nbformat.reads(text, as_version=4)
    everything = "\n".join(cell.source for cell in notebook.cells)
    assert "SOLUTION" not in everything
    assert "### COPY" not in everything
    for cell in parse_master(master):
        # What is copied comes from another cell, whose lines are looked for.
        if cell.kind is CellRole.SOLUTION and not COPY_LINE.search(cell.source):
            region = find_region(cell.source)
            # A repair is made of lines that students get: of the broken code, or of another ticket.
            for line in () if region.is_repair else set(region.answer) - set(region.stub):
                # A hint may say how a method begins, and a short line is nobody's secret.
                if len(line.strip()) > len("return total") and not line.strip().startswith("def "):
                    assert line.strip() not in everything, line


@each_master
def test_a_solution_cell_asks_for_one_thing(master: Path) -> None:
    for named in named_cells(master):
        if named.cell.kind is CellRole.SOLUTION:
            region = find_region(named.cell.source)
            assert len(region.stub) == 1 or region.is_repair, f"{named.name}: the TODO is one line"
            assert region.unsolved.count("TODO") + region.unsolved.count(COPIED) == 1


@each_master
def test_nbgrader_accepts_source_and_release(master: Path) -> None:
    for notebook in (source_notebook(master), nbformat.read(chapter_path(ROOT, master), as_version=4)):
        nbformat.validate(notebook)
        MetadataValidatorV3().validate_nb(notebook)


def test_every_exercise_is_checked_in_exactly_one_notebook() -> None:
    checked = [named.check.exercise for master in MASTERS for named in named_cells(master) if named.check]
    assert sorted(checked) == sorted(exercises.all_ids())


@each_master
def test_points_are_the_exercises_own(master: Path) -> None:
    for cell in nbformat.read(chapter_path(ROOT, master), as_version=4).cells:
        data = cell.metadata.get("nbgrader", {})
        if data.get("grade"):
            exercise = ast.literal_eval(ast.parse(cell.source).body[0].value.args[0])
            assert data["points"] == exercises.get(exercise).points


@each_master
def test_no_machine_is_named(master: Path) -> None:
    # Where ROS is on the computers of others.
    text = release_text(source_notebook(master)).replace("/opt/ros/jazzy/", "")
    assert not re.search(r"/(home|root|work|tmp|opt|usr)/", text)


@each_master
def test_it_keeps_the_house_rules(master: Path) -> None:
    assert broken_rules(master) == []
