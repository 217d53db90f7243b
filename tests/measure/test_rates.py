"""The table of rates: its arithmetic, and that the page quotes the file."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from autograder.authoring.answer_bank import Answer, answers
from autograder.verdict import Diagnosis, State, Verdict, to_json
from benchmarks.machine import machine
from tests.measure import rates, soak, steady_class
from tests.measure.ends import Ends, Repeated
from tests.mutation.report import Report, Survivor, Tally

TODAY = rates.Measured("short", "2026-01-01", 2.0, "python -m tests.made_up")


def verdict(key: str, score: float) -> str:
    state = State.PASSED if score == 10 else State.FAILED
    found = Verdict("lab_1_2.talker", "", state, score, 10.0, diagnosis=Diagnosis(key, "") if key else None)
    return to_json(found).decode()


def test_the_bank_is_counted() -> None:
    right = Answer("lab_1_2.talker", Path("right/a.py"), (), ())
    wrong = Answer("lab_1_2.talker", Path("wrong/b.py"), (), ("topic_name", "crashed"))
    listed = [right, replace(right, file=Path("right/c.py")), wrong]
    listed += [replace(wrong, file=Path(f"wrong/{name}.py")) for name in "defg"]
    ends = [
        ("", 10.0),
        ("crashed", 0.0),
        ("topic_name", 2.0),
        ("crashed", 0.0),
        ("never_spun", 0.0),
        ("", 10.0),
    ]
    lines = {answer.name: verdict(*end) for answer, end in zip(listed, ends, strict=False)}
    bank = rates.bank_rates(lines, listed)  # the last one was not judged
    assert (bank.right, bank.accepted, bank.wrong, bank.rejected) == (2, 1, 4, 3)
    assert (bank.diagnosed, bank.first) == (2, 1)
    assert len(bank.objections) == 3


def test_what_changed_and_what_survived_is_named() -> None:
    mutants = Report(
        99, {"lab_1_2.talker": Tally(9, 6, 1, 2, 0)}, (Survivor("x/y:z:1", 3, "", ("0",), 0),), ()
    )
    ends = Ends()
    for name, end in (
        ("one", "failed, 0 of 10"),
        ("one", "failed, 4 of 10"),
        ("two", "passed"),
        ("two", "passed"),
    ):
        ends.add(name, end)
    found = rates.Rates(
        machine(),
        bank=(TODAY, rates.Bank(10, 9, 20, 20, 19, 18, ("one: a correct answer got 3",))),
        mutants=(TODAY, mutants),
        soak=(TODAY, ends.result(2.0, "8 at a time")),
    )
    text = rates.markdown(found)
    assert "| right answers that are accepted | `bank` | 9 of 10 (90.0%) |" in text
    assert "| mutants of right answers that are rejected | `mutants` | 9 of 12 (75.0%) |" in text
    assert "| the same, without those that do what the task asks | `mutants` | 9 of 10 (90.0%) |" in text
    assert "- `mutants`: `python -m tests.made_up`: 12 of 99; short form, 2026-01-01, 2 minutes" in text
    assert "under load | `soak` | 1 of 2 (50.0%) |" in text
    assert "- `soak`: `python -m tests.made_up`: 4 verdicts, 8 at a time; short form" in text
    assert "- mutants that survived: `x/y:z:1`" in text
    assert "- changed: one: 1 times failed, 0 of 10; 1 times failed, 4 of 10" in text


def test_rates_are_kept_as_they_are(tmp_path: Path) -> None:
    found = rates.Rates(machine(), soak=(TODAY, Repeated(40, 21, 20, 2.0, "quietly")))
    rates.write(found, tmp_path / "rates.json")
    assert rates.read(tmp_path / "rates.json") == found


def test_the_page_quotes_the_rates_that_are_kept() -> None:
    """Whoever changes a rate by hand, or forgets the page, meets this."""
    assert rates.markdown(rates.read(rates.RESULTS)) in rates.PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize("same_inputs", [True, False])
def test_a_soak_draws_every_answer_as_often(same_inputs: bool) -> None:
    wanted = list(answers())[:7]
    turns = soak.drawn(wanted, 35, 0, same_inputs=same_inputs)
    assert turns == soak.drawn(wanted, 35, 0, same_inputs=same_inputs)
    assert turns != soak.drawn(wanted, 35, 1, same_inputs=same_inputs)
    for answer in wanted:
        seeds = {turn.seed for turn in turns if turn.subject == answer}
        assert sum(turn.subject == answer for turn in turns) == 5
        assert len(seeds) == (1 if same_inputs else 5)


def test_a_soak_of_many_answers_judges_some_of_them_again_and_again() -> None:
    """A bank of more answers than there were judgements had each judged once, and nothing could change."""
    turns = soak.drawn(list(answers())[:50], 40, 0, same_inputs=False)
    assert set(Counter(turn.subject.name for turn in turns).values()) == {soak.EACH}


def test_a_class_knows_what_is_to_be_expected() -> None:
    ends = {
        "ada exercise_1_2.three_ints": "passed, 10 of 10",
        "ben exercise_1_2.three_ints": "failed, 9 of 10, waits_forever",
        "fay exercise_1_2.three_ints": "failed, 5 of 10, one_call_only",
        "dan lab_1_2.talker": "failed, 8 of 10, rate",
        "eva lab_1_4.server": "passed, 10 of 10",
        "eva lab_1_4.client": "not_checked, 0 of 10, not_checked",
    }
    assert set(steady_class.unexpected(ends)) == {
        "ben exercise_1_2.three_ints",
        "dan lab_1_2.talker",
        "eva lab_1_4.client",
    }
