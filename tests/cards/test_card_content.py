"""The reference solution: folded up on a card with full marks, and offered after some failures."""

from __future__ import annotations

from dataclasses import replace

from autograder.cards import html_rendering
from autograder.cards.card_content import Solution
from autograder.cards.card_wording import OFFER, OTHER_WAY, OUR_CHANGE, OWN_CHANGE, SOLUTION
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


BROKEN = "# TODO: repair it.\nclass A:\n    x = 1\n    y = 2\n    z = 3\n    w = '<4>'\n    v = 5"
REPAIR = Solution(
    (BROKEN.replace("# TODO: repair it.\n", "").replace("x = 1", "x = 2"),),
    broken=(BROKEN,),
    own=(f"{BROKEN.replace('v = 5', 'v = 6')}\n",),
)


def test_of_a_repair_the_card_shows_our_change_beside_the_students_own() -> None:
    card = html_rendering.card_bundle(FULL, solution=REPAIR)
    html, text = card["text/html"], card["text/plain"]
    assert SOLUTION not in str(card)
    assert REPAIR.changes == {
        OUR_CHANGE: [" class A:", "-    x = 1", "+    x = 2", "     y = 2"],
        OWN_CHANGE: ["     w = '<4>'", "-    v = 5", "+    v = 6"],
    }
    assert '<span class="agc-added">+    x = 2</span>' in html
    assert "w = &#39;&lt;4&gt;&#39;" in html
    assert (
        text.index(OUR_CHANGE) < text.index("  | +    x = 2") < text.index(OWN_CHANGE) < text.index("v = 6")
    )


def test_a_repair_that_cannot_be_read_leaves_ours_alone() -> None:
    html = html_rendering.card_bundle(FULL, solution=replace(REPAIR, own=("",)))["text/html"]
    assert (OUR_CHANGE in html, OWN_CHANGE in html) == (True, False)


def test_before_the_pass_no_repair_is_shown() -> None:
    failed = html_rendering.card_bundle(replace(FULL, state=State.FAILED), solution=REPAIR)
    assert OUR_CHANGE not in str(failed)


def test_equal_lines_between_two_changes_are_left_out() -> None:
    ours = BROKEN.replace("x = 1", "x = 2").replace("v = 5", "v = 6")
    assert "…" in replace(REPAIR, code=(ours,)).changes[OUR_CHANGE]
