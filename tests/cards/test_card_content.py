"""The reference solution, which a card offers with full marks, folded up."""

from __future__ import annotations

from dataclasses import replace

from autograder.cards import html_rendering
from autograder.cards.card_content import Solution
from autograder.cards.card_wording import OTHER_WAY, SOLUTION
from autograder.verdict import State, Verdict

FULL = Verdict("lab_9_1.battery", "The battery", State.PASSED, 10, 10)
REFERENCE = Solution(
    ("%%writefile a.xml\n<a/>", "x = 1"), "A `timer` keeps the pace.", "Or a loop:", "while True: ..."
)


def test_full_marks_offer_it_folded_up() -> None:
    card = html_rendering.card_bundle(FULL, solution=REFERENCE)
    html = card["text/html"]
    assert f'<details class="agc-fold agc-solution">\n<summary>{SOLUTION}' in html
    assert "&lt;a/&gt;" in html
    assert "A <code>timer</code> keeps the pace." in html
    assert html.index("x = 1") < html.index(f"{OTHER_WAY}.") < html.index("while True: ...")
    for words in (SOLUTION, "  | <a/>", "  | x = 1", f"{OTHER_WAY}. Or a loop:", "  | while True: ..."):
        assert words in card["text/plain"]


def test_anything_less_does_not() -> None:
    without = html_rendering.card_bundle(FULL)
    assert SOLUTION not in str(without)
    for state, score in ((State.FAILED, 9), (State.FAILED, 10), (State.NOT_CHECKED, 0)):
        assert SOLUTION not in str(
            html_rendering.card_bundle(replace(FULL, state=state, score=score), solution=REFERENCE)
        )


def test_where_there_is_no_other_way_none_is_mentioned() -> None:
    card = html_rendering.card_bundle(FULL, solution=Solution(("x = 1",), "Because."))
    assert OTHER_WAY not in card["text/html"]
    assert OTHER_WAY not in card["text/plain"]
