"""The sweep over the bank's cards notices each thing that no card may say."""

from __future__ import annotations

import pytest

from autograder.verdict import CriterionResult, Diagnosis, State, Verdict
from tests.cards.sweep import objection

RAISED = 'Traceback (most recent call last):\n  File "a.py", line 3, in f\n    g()\nKeyError: 1'


def card(text: str, *, seen: str = "2 messages", held: str = "Builds", detail: str = "") -> Verdict:
    criteria = (
        CriterionResult("a", held, 1, True, "", ""),
        CriterionResult("b", "Says it", 1, False, "x", seen),
    )
    return Verdict(
        "lab_1_2.talker", "X", State.FAILED, 1, 2, criteria, Diagnosis("key", text, "Do this."), detail=detail
    )


@pytest.mark.parametrize(
    ("verdict", "why"),
    [
        (card("It said \x1b[31mhello."), "its card says"),
        (card("It said [31;1mhello."), "its card says"),
        (card("The name must be [N]{11}."), "its card says"),
        (card("It sent 1 feedback messages."), "its card says"),
        (card("It has the fields  --- ;"), "its card says"),
        (
            card("Nothing came.", held="Subscribes to /chatter", seen="no node subscribed to /chatter"),
            "holds, beside",
        ),
        (card("That line has no colon."), "names none"),
        (card("It stopped with TypeError: no.", detail=RAISED), "of a TypeError"),
        (card("It stopped.", seen="the program did nothing", detail=RAISED), "that raised"),
        (card("It said “one text”.", seen="“another one” 2 times"), "its criteria “another one”"),
    ],
)
def test_what_no_card_may_say_is_noticed(verdict: Verdict, why: str) -> None:
    assert why in objection(verdict)


def test_a_card_may_say_all_else() -> None:
    assert objection(card("It stopped with KeyError: 1. That line asks for “one text”.", detail=RAISED)) == ""
