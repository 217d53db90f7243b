"""What comes to no verdict is judged once more, when nothing else is; which diagnosis is as expected."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from autograder.authoring.answer_bank import Answer, Turn, judge_all
from autograder.verdict import Diagnosis, State, Verdict, not_checked, to_json

AT_ONCE = 3


@dataclass(frozen=True)
class NeverChecked:
    """Writes down when it is judged."""

    name: str
    journal: Path

    def verdict(self, seed: str) -> bytes:
        del seed
        for word in ("begins", "ends"):
            with self.journal.open("a") as file:
                file.write(f"{word}\n")
        return to_json(not_checked("lab_1_2.talker", "", 10, "the machine is too busy"))


def test_what_could_not_be_checked_is_judged_again_one_at_a_time(tmp_path: Path) -> None:
    journal, verdicts = tmp_path / "journal", []

    def done(turn: Turn[NeverChecked], verdict: Verdict) -> None:
        verdicts.append((turn.subject.name, verdict.state))

    def failed(turn: Turn[NeverChecked], trouble: str) -> None:
        raise AssertionError(f"{turn.subject.name}: {trouble}")

    names = ["a", "b", "c"]
    turns = [Turn(NeverChecked(name, journal), "seed") for name in names]
    judge_all(turns, jobs=AT_ONCE, done=done, failed=failed)
    assert sorted(verdicts) == [(name, State.NOT_CHECKED) for name in names]
    words = journal.read_text().split()
    assert len(words) == 2 * AT_ONCE * 2
    assert words[2 * AT_ONCE :] == ["begins", "ends"] * AT_ONCE


@pytest.mark.parametrize(
    ("expected", "told", "as_expected"),
    [
        ("unknown", "unknown", True),
        ("unknown", "effect", True),  # which drawing it is decides whether an effect can be told
        ("unknown", "mutant", False),
        ("effect", "unknown", False),
        ("crashed", "effect", False),
    ],
)
def test_an_effect_may_be_told_where_the_cause_may_stay_unknown(
    expected: str, told: str, as_expected: bool
) -> None:
    answer = Answer("lab_1_2.talker", Path("wrong/one.py"), (), (expected,))
    verdict = Verdict("lab_1_2.talker", "", State.FAILED, 0, 10, diagnosis=Diagnosis(told, ""))
    assert (answer.objection(verdict) == "") is as_expected
