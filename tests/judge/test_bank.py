"""Every answer of the bank gets the right verdict and the right diagnosis."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.authoring.answers import Answer, answers, named
from tests.judge.bank import main

if TYPE_CHECKING:
    from autograder.verdict import Verdict

BANK = list(answers())


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("answer", BANK, ids=lambda answer: answer.name)
def test_answer_is_judged_right(answer: Answer, verdicts: dict[str, Verdict]) -> None:
    verdict = verdicts[answer.name]
    assert answer.objection(verdict) == "", verdict.detail


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_the_bank_is_large_enough(exercise_id: str) -> None:
    counts = Counter(answer.file.parent.name for answer in BANK if answer.exercise == exercise_id)
    assert counts["right"] >= 5
    assert counts["wrong"] >= 8


def test_a_program_is_printed_as_it_is_judged(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wanted = named("lab_1_2.talker/wrong/counter_start.py")
    assert main(["--print", wanted.name]) == 0
    printed = capsys.readouterr().out
    judged = Path(wanted.unpack(tmp_path)[-1])
    assert (judged.parent, judged.name) == (tmp_path, "counter_start.py")
    assert printed == judged.read_text(encoding="utf-8") == wanted.text
    assert "self.i = 1\n" in printed
    assert main(["--print", "no_such_answer"]) == 1
