"""Two assignments of the instructor's own may each have a notebook of one name: neither takes the other's place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import write_zip
from test_collect import why, work

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

    from autograder.grading.collecting.collect import CollectReport

NAME = "Ada Lovelace_1_assignsubmission_file_{}"


@pytest.fixture
def klass(klass: TinyClass) -> TinyClass:
    """A class whose assignments ps1 and ps2 have a notebook problem1 each, with cells of their own."""
    source = klass.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    for name in ("ps1", "ps2"):
        folder = klass.path / "source" / name
        folder.mkdir()
        (folder / "problem1.ipynb").write_text(
            source.read_text().replace('"grade_id": "', f'"grade_id": "{name}-')
        )
    return klass


def of(klass: TinyClass, assignment: str) -> str:
    return work(klass).replace('"grade_id": "', f'"grade_id": "{assignment}-')


def gathered(klass: TinyClass, folder: Path, text: str, name: str, assignment: str = "") -> CollectReport:
    archive = write_zip(folder / "m.zip", {NAME.format(name): text})
    return collect(klass.path, [archive], assignment=assignment)


@pytest.mark.parametrize("name", ["problem1.ipynb", "problem1 (1).ipynb", "homework.ipynb"])
@pytest.mark.parametrize("assignment", ["", "asked"])
def test_the_cells_say_of_which_assignment_it_is(
    klass: TinyClass, tmp_path: Path, name: str, assignment: str
) -> None:
    for target in ("ps1", "ps2"):
        report = gathered(klass, tmp_path, of(klass, target), name, target if assignment else "")
        assert [one.assignment for one in report.having(LineState.PLACED)] == [target], why(report)
        there = klass.path / "submitted" / "ada" / target / "problem1.ipynb"
        assert there.read_text() == of(klass, target)


def test_of_another_assignment_it_is_refused(klass: TinyClass, tmp_path: Path) -> None:
    report = gathered(klass, tmp_path, of(klass, "ps2"), "problem1.ipynb", "ps1")
    assert "the file is the notebook of ps2, not of ps1" in why(report)
    report = gathered(klass, tmp_path, work(klass), "problem1.ipynb")
    assert "(ps1 or ps2 by its name, lab_1_2 by its cells)" in why(report)


def test_where_cells_say_nothing_the_instructor_does(klass: TinyClass, tmp_path: Path) -> None:
    nameless = work(klass).replace('"grade_id"', '"nobody"')
    report = gathered(klass, tmp_path, nameless, "problem1.ipynb")
    assert "(ps1 or ps2 by its name): write the assignment under assignment" in why(report)
    report = gathered(klass, tmp_path, nameless, "problem1.ipynb", "ps1")
    assert [one.assignment for one in report.having(LineState.PLACED)] == ["ps1"]


def test_of_an_assignment_of_several_notebooks_the_name_says_which(klass: TinyClass, tmp_path: Path) -> None:
    (klass.path / "source" / "ps1" / "problem2.ipynb").write_text("{}")
    nameless = work(klass).replace('"grade_id"', '"nobody"')
    report = gathered(klass, tmp_path, nameless, "homework.ipynb", "ps1")
    assert "which notebook of ps1 the file is (problem1, problem2): write the notebook under notebook" in why(
        report
    )
