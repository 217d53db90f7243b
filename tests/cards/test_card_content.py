"""The reference solution: folded up on a card with full marks, and offered after some failures."""

from __future__ import annotations

from dataclasses import replace

from autograder.cards import html_rendering
from autograder.cards.card_content import Solution
from autograder.cards.card_wording import OFFER, OTHER_WAY, SOLUTION
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


def test_no_card_has_it_by_itself() -> None:
    assert SOLUTION not in str(html_rendering.card_bundle(FULL))


def test_a_student_who_has_opened_it_sees_it_unfolded() -> None:
    card = html_rendering.card_bundle(replace(FULL, state=State.FAILED, score=9), solution=REFERENCE)
    assert f'<details class="agc-fold agc-solution" open="open">\n<summary>{SOLUTION}' in card["text/html"]


def test_only_the_card_of_a_notebook_offers_it_and_a_short_one_does_not() -> None:
    failed = replace(FULL, state=State.FAILED, score=9)
    assert OFFER in html_rendering.card_bundle(failed, offers_solution=True)["text/html"]
    assert OFFER not in html_rendering.card_bundle(failed)["text/html"]
    assert OFFER not in html_rendering.card_bundle(failed, offers_solution=True, short=True)["text/html"]
    assert OFFER not in html_rendering.card_html(failed, offers_solution=True)


def test_where_there_is_no_other_way_none_is_mentioned() -> None:
    card = html_rendering.card_bundle(FULL, solution=Solution(("x = 1",), "Because."))
    assert OTHER_WAY not in card["text/html"]
    assert OTHER_WAY not in card["text/plain"]
