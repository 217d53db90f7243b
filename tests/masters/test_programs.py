"""The programs that the notebooks write work: with the student's code in them they earn full marks."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import nbformat
import pytest

from autograder.judge.command_check import check_and_keep
from autograder.masters.code_cells import COPIED, WrittenFile, written_file
from autograder.masters.master_cells import CellRole
from autograder.masters.master_files import masters
from autograder.masters.notebook_release import release_text
from autograder.masters.source_notebooks import named_cells, source_notebook

ROOT = Path(__file__).resolve().parents[2]
CHECKED = [
    (master, named.check.exercise, named.check.subject)
    for master in masters(ROOT)
    # Parsed once: every process of tests comes by here.
    for cells in [named_cells(master)]
    # The first notebook writes no program yet.
    if any(written_file(other.cell.source) for other in cells)
    for named in cells
    # Where the subject is a path, the check looks at the files.
    if named.cell.kind is CellRole.CHECK and named.check is not None and not named.check.is_path
    # Not every class becomes a program.
    if any(f"{named.check.subject}(" in other.cell.source.partition("def main()")[2] for other in cells)
]
each_checked = pytest.mark.parametrize(
    ("master", "exercise", "subject"), CHECKED, ids=[exercise for _, exercise, _ in CHECKED]
)


def program(sources: list[str], subject: str) -> WrittenFile:
    """The one program among the cells of a notebook that calls what is judged."""
    files = [file for source in sources if (file := written_file(source)) is not None]
    (found,) = (file for file in files if f"{subject}(" in file.text.partition("def main()")[2])
    return found


@pytest.mark.ros
@each_checked
def test_the_program_earns_full_marks(master: Path, exercise: str, subject: str, tmp_path: Path) -> None:
    file = tmp_path / "program.py"
    file.write_text(program([named.cell.source for named in named_cells(master)], subject).text)
    verdict, _ = check_and_keep(exercise, [sys.executable, str(file)], cwd=tmp_path)
    assert verdict.passed, verdict


@each_checked
def test_students_get_all_of_the_program_but_their_own_part(
    master: Path, exercise: str, subject: str
) -> None:
    chapter = nbformat.reads(release_text(source_notebook(master)), as_version=4)
    given = program([cell.source for cell in chapter.cells], subject).text
    compile(given, exercise, "exec")
    assert "# TODO: copy" in given or COPIED in given
    assert not re.search(rf"^(class|def) {subject}\b", given, re.MULTILINE)
    assert "autograder" not in given
