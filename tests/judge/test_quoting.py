"""A card quotes the line that its diagnosis is about, or none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.authoring.answers import named
from autograder.judge.subjects.command import check_and_keep
from autograder.judge.verdicts import keeping, reference
from tests.judge.quoting import objection

if TYPE_CHECKING:
    from pathlib import Path

QUOTING = {
    "exercise_1_3.cancel/wrong/cancel_repeated_and_raises.py": "",
    "exercise_1_3.cancel/wrong/status_misreported_claimed_and_raises.py": "",
    "lab_1_3.server/wrong/wrong_sum_one_more.py": "",
    "lab_1_3.server/wrong/field_type.py": "SystemError",
}
"""Answers, and what the last line of the traceback on the card begins with; empty where there must be none."""


@pytest.mark.ros
@pytest.mark.parametrize("name", QUOTING)
def test_the_line_and_the_diagnosis_come_from_one_run(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Tests of notebooks switch the checks of message fields on; a terminal has them off.
    monkeypatch.delenv("ROS_PYTHON_CHECK_FIELDS", raising=False)
    answer = named(name)
    verdict, kept = check_and_keep(answer.exercise, answer.unpack(tmp_path), seed="quoted")
    evidence = keeping.evidence_of(keeping.unpack(kept), reference.load(answer.exercise))
    assert answer.objection(verdict) == ""
    assert objection(verdict, evidence) == ""
    last = verdict.detail.splitlines()[-1:]
    assert [line[: len(QUOTING[name])] for line in last] == [QUOTING[name]] * bool(QUOTING[name])
