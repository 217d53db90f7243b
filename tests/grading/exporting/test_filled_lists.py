"""A list of the LMS's own keeps what the class says nothing about, and no points go into another's line or column."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from downloads import ROSTER

from autograder.cli import cli
from autograder.grading.exporting.export_files import export

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import FakeEngine, TinyClass

WORKSHEET = (
    "Identifier,Full name,Email address,Grade,Maximum Grade\n"
    "Participant 31,Ada Lovelace,ada.love@uni.example,3,20\n"
)
CANVAS = 'Student,ID,SIS User ID,SIS Login ID,Section,lab_1_2\n"Lovelace, Ada",101,,al,A,8\n'
GRADESCOPE = "Name,SID,Email,lab_1_2\nAda Lovelace,ada,ada.love@uni.example,8\n"


@pytest.fixture
def klass(tiny: TinyClass, fake_engine: FakeEngine) -> TinyClass:
    """Ben's work was graded; Ada has handed in nothing."""
    (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    tiny.submit("ben", 7, 10)
    tiny.grade()
    return tiny


def rows(path: Path) -> list[list[str]]:
    return list(csv.reader(io.StringIO(path.read_text("utf-8-sig"))))


@pytest.mark.parametrize(
    ("text", "lms"), [(WORKSHEET, "moodle"), (CANVAS, "canvas"), (GRADESCOPE, "gradescope")]
)
def test_a_list_of_another_system_than_the_named_one_is_refused(
    klass: TinyClass, tmp_path: Path, text: str, lms: str
) -> None:
    """A worksheet of Moodle's has one column for points: of several assignments the last would have filled it."""
    into = tmp_path / "list.csv"
    into.write_text(text)
    for to in sorted({"canvas", "moodle", "gradescope", "csv", "xlsx"} - {lms}):
        said = CliRunner().invoke(cli, ["export", str(klass.path), "--to", to, "--into", str(into)])
        assert (said.exit_code, f"--to {lms}" in said.output) == (2, True), said.output
    assert not (klass.path / "export").exists()
    export(klass.path, lms, into=into)
