"""docs/your-own-repository.md shows what ``check --json`` prints: a sample made here, and a row for each field."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path

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


def test_each_field_has_its_row_and_no_row_is_of_another_field() -> None:
    known = {field.name for field in fields(Verdict)}
    nested = {"criteria[]": CriterionResult, "diagnosis": Diagnosis, "timeline[]": Moment, "ways[]": Way}
    for name, kind in nested.items():
        known |= {f"{name}.{field.name}" for field in fields(kind)}
    table = PAGE.partition("## What `check --json` prints")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| (`.+?`) \|", table, re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`([^`]+)`", row)}
    assert named == known


def test_each_state_is_on_the_page() -> None:
    printed = set(State) - {State.CHECKING}  # only a card that still grows has this one
    assert [state for state in printed if f"`{state}`" not in PAGE] == []
