"""The programs that the chapters print work: with the reference solution in them they earn full marks."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from autograder.judge.command import check_command
from autograder.masters.layout import masters
from autograder.masters.parsing import Kind
from autograder.masters.reference import reference_source
from autograder.masters.source import named_cells

ROOT = Path(__file__).resolve().parents[2]
CHECKED = [
    (master, named.check.exercise)
    for master in masters(ROOT)
    for named in named_cells(master)
    # Files that a notebook writes are programs already.
    if named.cell.kind is Kind.CHECK and named.check is not None and not named.check.is_path
]


def printed_program(master: Path, subject: str) -> str:
    """The code block of a master that has a main() for this subject in it; its only main() where none names it."""
    blocks = re.findall(r"^```python\n(.*?)^```", master.read_text(), flags=re.DOTALL | re.MULTILINE)
    programs = [block for block in blocks if "def main()" in block]
    (program,) = [block for block in programs if f"{subject}(" in block] or programs
    return str(program)


@pytest.mark.ros
@pytest.mark.parametrize(("master", "exercise"), CHECKED, ids=[exercise for _, exercise in CHECKED])
def test_the_printed_program_earns_full_marks(master: Path, exercise: str, tmp_path: Path) -> None:
    reference = reference_source(master, exercise)
    # The chapters promise that a program needs nothing of the notebook.
    solution = re.sub(r"^from autograder.*\n", "", reference.source, flags=re.MULTILINE)
    # Lab 1.2 prints one program for its two nodes.
    program = printed_program(master, reference.subject).replace("TalkerNode", reference.subject)
    file = tmp_path / "program.py"
    imports = "from rclpy.executors import ExternalShutdownException"
    file.write_text(f"{imports}\n{solution}\n{program}")
    verdict = check_command(exercise, [sys.executable, str(file)], cwd=tmp_path)
    assert verdict.passed, verdict
