"""A notebook with the cells of two labs goes to neither in silence: its points would count for one of them alone."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import nbformat
import pytest
from test_collect import why, work
from test_where_it_goes import MOODLE, gathered

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collected_files import LineState
from autograder.grading.new_classes.new_class import release
from autograder.grading.table.rows import remarks_on
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import FakeEngine, TinyClass


NAMES = cases(__file__, "NAMES")


def as_other_lab(text: str) -> str:
    for name, other in sorted(NAMES.items(), reverse=True):
        text = text.replace(name, other)
    return text


@pytest.fixture
def klass(klass: TinyClass) -> TinyClass:
    """A class with a second lab, which has checks of its own."""
    source = klass.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    other = klass.path / "source" / "lab_1_3" / "lab_1_3.ipynb"
    other.parent.mkdir()
    other.write_text(as_other_lab(source.read_text()))
    release(ClassDirectory(klass.path))
    return klass


def of_both(klass: TinyClass, *, order: int = 1, marked: bool = True) -> str:
    """One notebook with the cells of both labs, and with the nbgrader metadata or only the ids of its cells."""
    text = work(klass, 3)
    both, other = (nbformat.reads(one, as_version=4) for one in (text, as_other_lab(text)))
    both.cells = [*both.cells, *other.cells][::order]
    for cell in both.cells if not marked else ():
        cell.metadata.pop("nbgrader", None)
    return json.dumps(both)


@pytest.mark.parametrize("name", ["lab_1_2.ipynb", "lab_1_3.ipynb", "work.ipynb"])
@pytest.mark.parametrize(("order", "marked"), [(1, True), (-1, True), (1, False)])
def test_a_notebook_with_the_cells_of_two_labs_is_refused_with_both_names(
    klass: TinyClass, tmp_path: Path, name: str, order: int, marked: bool
) -> None:
    file = {MOODLE.format("Ada Lovelace", name): of_both(klass, order=order, marked=marked)}
    report = gathered(klass, tmp_path, file)
    assert not report.having(LineState.PLACED)
    assert report.exit_code == 2
    assert "lab_1_2 or lab_1_3 by its cells" in why(report)
    assert "write the assignment under assignment" in why(report)


def test_the_instructor_says_for_which_of_them_it_is_and_grade_repeats_what_is_left(
    klass: TinyClass, tmp_path: Path, fake_engine: FakeEngine
) -> None:
    file = {MOODLE.format("Ada Lovelace", "work.ipynb"): of_both(klass)}
    for assignment in ("lab_1_2", "lab_1_3"):
        report = gathered(klass, tmp_path, file, assignment=assignment)
        assert [one.assignment for one in report.having(LineState.PLACED)] == [assignment]
    remarks = remarks_on(klass.grade(assignments=["lab_1_2"]).rows)
    assert remarks["ada", "lab_1_2"].startswith("This notebook also has the checks of lab_1_3.")


def test_a_copied_answer_of_another_lab_makes_no_second_lab(klass: TinyClass, tmp_path: Path) -> None:
    text = work(klass, 3)
    own, other = (nbformat.reads(one, as_version=4) for one in (text, as_other_lab(text)))
    own.cells += [
        cell for cell in other.cells if cell.metadata.get("nbgrader", {}).get("grade_id") == "Server"
    ]
    report = gathered(klass, tmp_path, {MOODLE.format("Ada Lovelace", "lab_1_2.ipynb"): json.dumps(own)})
    assert [one.assignment for one in report.having(LineState.PLACED)] == ["lab_1_2"]
