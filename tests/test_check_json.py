"""docs/your-own-repository.md shows what ``check --json`` prints: a sample made here, and who explains its fields."""

from __future__ import annotations

import inspect
import json
import re
from dataclasses import fields
from pathlib import Path

import pytest

from autograder.verdict import CriterionResult, Diagnosis, Moment, State, Verdict, Way, to_json

PAGE = (Path(__file__).resolve().parents[1] / "docs/your-own-repository.md").read_text(encoding="utf-8")
SAMPLE = Verdict(
    exercise="lab_1_1.battery",
    title="A publisher · The battery",
    state=State.FAILED,
    score=6.0,
    max_score=10.0,
    criteria=(
        CriterionResult(
            "charge",
            "Counts down from 100",
            4.0,
            False,
            "100, 99, 98, 97, 96, …",
            "100, 98, 96, 94, 92, 90, …",
        ),
    ),
    diagnosis=Diagnosis(
        "counter_step",
        "After 100 comes 98 (100, 98, 96, 94, 92, 90, …). The numbers must go down by one with each message.",
        "Count once for each published message.",
    ),
    timeline=(Moment(1.09, "/battery", "from_subject", "100"),),
    seed="84af52c68226cef8",
    seconds=13.7,
)


def test_the_sample_on_the_page_is_made_from_the_types() -> None:
    (shown,) = re.findall(r"^```json\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    assert shown == json.dumps(json.loads(to_json(SAMPLE)), indent=1, ensure_ascii=False) + "\n"


@pytest.mark.parametrize("kind", [Verdict, CriterionResult, Diagnosis, Moment, Way])
def test_each_field_is_explained_where_the_page_sends_its_reader(kind: type[Verdict]) -> None:
    text = str(inspect.getdoc(kind)).partition("Attributes:")[2]
    explained = re.findall(r"^ {4}(\w+): ", text, re.MULTILINE)
    assert explained == [field.name for field in fields(kind)]
    assert 'help("autograder.verdict")' in PAGE


def test_each_state_is_on_the_page() -> None:
    printed = set(State) - {State.CHECKING}  # only a card that still grows has this one
    assert [state for state in printed if f"`{state}`" not in PAGE] == []
