"""What is kept of the mutants of each solution fits the reference output, and gives no line of the solution away."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec
import pytest

from autograder import exercises, packed_files
from autograder.authoring.mutants.operators import PYTHON
from autograder.authoring.mutants.solutions import solution
from autograder.judge import evidence_files
from autograder.kit.oracle.naming.deltas import Mutants
from autograder.kit.oracle.naming.mutant_words import TABLE

ROOT = Path(__file__).parents[2]
RECORDED = [one for one in exercises.all_ids() if exercises.mutants_path(one).exists()]
MOST = 20_000
"""Bytes of one file: all of them are in each hand-out."""


@pytest.mark.parametrize("exercise_id", RECORDED)
def test_what_the_mutants_do_was_recorded_with_the_reference_output(exercise_id: str) -> None:
    assert evidence_files.load_reference(exercise_id).mutants is not None, f"./course record {exercise_id}"


@pytest.mark.parametrize("exercise_id", RECORDED)
def test_no_line_of_a_solution_is_handed_out_with_them(exercise_id: str) -> None:
    data = packed_files.read(exercises.mutants_path(exercise_id))
    found = msgspec.json.decode(data, type=Mutants)
    told = {text for one in found.meanings for text in (one.kind, one.name)}
    of = solution(exercise_id)
    assert of is not None
    lines = {
        line.strip()
        for begin, end in of.own
        for line in of.text[begin:end].splitlines()
        if len(line.strip()) > 12
    }
    assert {line for line in lines if any(line in text for text in told)} == set()
    assert {one.quote for one in found.meanings} - {""} <= {
        " ".join(one.split()) for one in exercises.get(exercise_id).text
    }
    assert exercises.mutants_path(exercise_id).stat().st_size < MOST


def test_the_mutants_of_most_declared_exercises_are_recorded() -> None:
    assert len(RECORDED) >= 15


def test_each_row_of_the_words_is_about_an_operator_and_has_its_paragraph() -> None:
    assert {row.operator for row in TABLE} <= {operator.__name__ for operator in PYTHON}
    headings = re.findall(r"^### .+$", (ROOT / "docs/mistakes.md").read_text(), re.MULTILINE)
    explained = set(re.findall(r"`(\w+)`", " ".join(headings)))
    assert {row.key for row in TABLE} | {"other_number", "effect"} <= explained
