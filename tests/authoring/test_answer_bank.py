"""What comes to no verdict is judged once more, when nothing else is; which diagnosis is as expected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.authoring.answer_bank import Turn, answers, judge_all
from autograder.verdict import Diagnosis, State, Verdict, not_checked, to_json

if TYPE_CHECKING:
    from pathlib import Path

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


def test_an_effect_may_be_told_where_the_cause_may_stay_unknown() -> None:
    answer = next(one for one in answers() if "unknown" in one.diagnoses)
    verdicts = {
        key: Verdict(answer.exercise, "", State.FAILED, 0, 10, diagnosis=Diagnosis(key, ""))
        for key in ("unknown", "effect", "mutant")
    }
    as_expected = [key for key, verdict in verdicts.items() if not answer.objection(verdict)]
    assert as_expected == ["unknown", "effect"]
