"""The plain-text twin: complete, within its width, safe for a terminal."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.cards.card_content import IN_A_TERMINAL
from autograder.cards.readable_text import width as columns
from autograder.cards.text_rendering import card_text
from autograder.verdict import CriterionResult, State, Verdict, not_checked

if TYPE_CHECKING:
    from collections.abc import Callable

GOLDEN = Path(__file__).parent / "golden"


@pytest.mark.parametrize("width", [40, 60, 88, 132])
def test_keeps_its_width(verdict: Verdict, width: int) -> None:
    for line in card_text(verdict, width=width).splitlines():
        if not line.startswith("  | "):
            assert columns(line) <= width, line


def test_sends_no_control_character_to_a_terminal(verdict: Verdict) -> None:
    text = card_text(verdict)
    text.encode("utf-8")
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\u2028\u2029]", text)


def test_color_adds_codes_and_nothing_else(verdict: Verdict) -> None:
    colored = card_text(verdict, color=True)
    assert "\x1b[" in colored
    assert re.sub(r"\x1b\[[0-9;]*m", "", colored) == card_text(verdict)


def test_every_criterion_appears_in_words(verdict: Verdict) -> None:
    text = card_text(verdict)
    joined = " ".join(text.split())
    if verdict.nothing_seen:
        return
    assert text.count("[PASS]") == sum(bool(criterion.passed) for criterion in verdict.criteria)
    assert text.count("[NOT YET]") == sum(not criterion.passed for criterion in verdict.criteria)
    for criterion in verdict.criteria:
        assert " ".join(criterion.title.split()) in joined
        if not criterion.passed and len(criterion.seen) < 160:
            assert f"expected: {criterion.expected} seen: {criterion.seen}" in joined


def test_before_the_first_line_is_written_the_text_lists_what_is_asked(
    load: Callable[[str], Verdict],
) -> None:
    text = card_text(load("talker_unsolved"))
    assert (
        "  - Counts up from the start (2 points)\n  - Keeps the rate (3 points)\n    A timer or any" in text
    )
    assert "\n  Not graded: “log the string that it publishes”.\n" in text


def test_what_counts_is_said_of_what_is_not_met(load: Callable[[str], Verdict]) -> None:
    verdict = replace(load("talker_unsolved"), nothing_seen=False)
    assert card_text(verdict).count("    what counts: A timer or any other way to keep it.\n") == 1
    met = replace(verdict, criteria=tuple(replace(one, passed=True) for one in verdict.criteria))
    assert "what counts" not in card_text(met)


def test_its_own_marks_are_ascii() -> None:
    failed = CriterionResult("rate", "Rate", 1.0, False, "x" * 500, "y" * 500)
    verdict = Verdict("e", "E" * 500, State.FAILED, 0.0, 1.0, (failed,), detail="line\n" * 500, seed="s")
    assert card_text(verdict).isascii()


def test_what_could_not_be_checked_accuses_nobody(load: Callable[[str], Verdict]) -> None:
    for verdict in (load("not_checked"), not_checked("lab_1_2.talker", "The talker", 10.0, "")):
        text = card_text(verdict)
        assert "COULD NOT BE CHECKED: no points counted" in text
        assert "not your mistake" in " ".join(text.split())
        for accusation in ("NOT YET", "0 of 10", "What happened", "failed", "wrong"):
            assert accusation not in text


def test_says_the_same_as_the_diagnosis(load: Callable[[str], Verdict]) -> None:
    verdict = load("talker_wrong_topic")
    joined = " ".join(card_text(verdict).split())
    assert verdict.diagnosis is not None
    assert f"What happened {verdict.diagnosis.text}" in joined
    assert f"What to do next > {verdict.diagnosis.next_step}" in joined


def test_every_moment_is_a_line(load: Callable[[str], Verdict]) -> None:
    lines = card_text(load("three_ints_partial")).splitlines()
    assert "      0.214 s  add_two_ints --> 12 + 5" in lines
    assert "      0.215 s  add_two_ints <-- sum = 17" in lines
    assert "      2.000 s  add_two_ints  *  the service appears" in lines
    assert not any("left out" in line for line in lines)


def test_a_long_timeline_is_cut_and_says_so(load: Callable[[str], Verdict]) -> None:
    text = card_text(load("cancel_failed"))
    shown = len(re.findall(r"^ +\d+\.\d{3} s ", text, flags=re.MULTILINE))
    assert shown <= IN_A_TERMINAL.moments
    assert f"... {44 - shown} more left out here" in text
    assert "final status: 4" in text  # the end is kept


def test_a_traceback_keeps_its_end(load: Callable[[str], Verdict]) -> None:
    crashed = load("crashed")
    long = replace(crashed, detail="start\n" + "  more\n" * 1000 + crashed.detail)
    text = card_text(long)
    assert "  | AttributeError: 'String' object has no attribute 'dta'" in text
    assert "lines left out" in text
    assert len(text.splitlines()) < 120


@pytest.mark.parametrize("name", ["talker_wrong_topic", "three_ints_partial"])
def test_looks_as_it_was_agreed(name: str, load: Callable[[str], Verdict]) -> None:
    """Run with ``UPDATE_GOLDEN=1`` after a change that is meant, and read the difference."""
    text = card_text(load(name)) + "\n"
    path = GOLDEN / f"{name}.txt"
    if os.environ.get("UPDATE_GOLDEN"):
        path.write_text(text, encoding="utf-8")
    assert text == path.read_text(encoding="utf-8")
