"""Formgrader's own button, with nothing in place of judge, box and kernel: what it enters is what the judge decided."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from playwright.sync_api import expect

sys.path.insert(0, str(Path(__file__).parents[1] / "grading"))
sys.path.insert(0, str(Path(__file__).parents[1] / "grading" / "day"))
from formgrader import Formgrader
from gradebook_truth import read_truth
from own_assignment import hand_in, write_assignment
from server_of_a_test import jupyter_server
from tiny_class import TinyClass

from autograder import course
from autograder.cli import cli
from autograder.grading.new_classes.new_class import new_class
from tests.submissions.odd_notebooks import odd_notebooks, text_of

if TYPE_CHECKING:
    from playwright.sync_api import Page

LAB, OWN = "exercise_1_2", "own"


@pytest.mark.browser
@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning")
def test_formgraders_button_has_the_judge_decide(page: Page, tmp_path: Path) -> None:
    made = TinyClass(tmp_path / "class")
    new_class(made.path, course.root(), assignments=[LAB])
    write_assignment(made, OWN)
    samples = {one.student: one for one in odd_notebooks() if one.assignment == LAB}
    for student, sample in samples.items():
        folder = made.path / "submitted" / student / LAB
        folder.mkdir(parents=True)
        (folder / f"{LAB}.ipynb").write_text(text_of(made.path, sample), encoding="utf-8")
    hand_in(made, "all-right", "def add(a, b):\n    return abs(a) - abs(b)", OWN)
    points = {
        student: sum(score for score, _ in sample.expected.values()) for student, sample in samples.items()
    }
    most = 10 * len(samples["all-right"].expected)
    assert len(set(points.values())) > 1, "one is right, and one is not"

    with jupyter_server(["jupyter", "server"], "teacher", tmp_path, os.environ, made.path) as address:
        formgrader = Formgrader(page, address, "teacher")
        for student, score in points.items():
            expect(formgrader.autograde(LAB, student)).to_contain_text(f"{score:g} / {most}")
        expect(formgrader.autograde(OWN, "all-right")).to_contain_text("3.5 / 10")

    truth = read_truth(made.path)
    assert {student: truth.score(student, LAB) for student in samples} == points
    assert truth.score("all-right", OWN) == 3.5
    said = CliRunner().invoke(cli, ["grade", str(made.path)])
    assert said.exit_code == 0, said.output
    assert f"0 notebooks run, {len(samples) + 1} unchanged" in said.output
    assert read_truth(made.path) == truth
