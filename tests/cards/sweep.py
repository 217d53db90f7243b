"""Sentences that no card may say, whatever the answer: asked of the card of each answer of the bank."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import re2

from autograder import exercises
from autograder.cards import card_wording
from autograder.cards.readable_text import TRACEBACK, students_line
from autograder.verdict import State

if TYPE_CHECKING:
    from autograder.verdict import Verdict

_NO_WORDS = re2.compile(r"\x1b|\[\d+(?:;\d+)*m|\[[A-Z]\]\{|\(\?[:P<]|\\[dws][+*]|%\(|  ---|--- ;")
"""Traces of a terminal's colours, of a pattern, or of an empty value."""
_NO_NODE = re2.compile(r"no node (?:subscribed|published)|no (?:subscription|publisher)\b")
_MEETS = re2.compile(r"^(?:Subscribes|Publishes) ")
_SINGULAR = re2.compile(r"\b1 (?:\w+ )?(?:messages|calls|goals|times|numbers|runs)\b")
_RAISED = re2.compile(r"\b([A-Z]\w*(?:Error|Exception)): ")
_QUOTED = re2.compile(r"“([^”]*)”(?:[^:]|$)")
"""What is quoted, but no title of a criterion, which a colon follows."""
_POINTS_AT = re2.compile(r"\b[Tt]hat line\b|line that is in your code")


def objection(verdict: Verdict) -> str:
    """What is wrong about the words of a card; empty where nothing is."""
    if verdict.state is not State.FAILED or verdict.diagnosis is None:
        return ""
    advice = card_wording.advice(verdict)
    missed = [criterion.seen for criterion in verdict.criteria if not criterion.passed]
    words = " ".join((advice.text, advice.next_step, *missed))
    if found := _NO_WORDS.search(words) or _SINGULAR.search(words):
        return f"its card says {found[0]!r}: {words}"
    held = [
        criterion.title
        for criterion in verdict.criteria
        if criterion.passed and _MEETS.search(criterion.title)
    ]
    if held and _NO_NODE.search(words):
        return f"its card says that {held[0]!r} holds, beside: {words}"
    if _POINTS_AT.search(words) and not (students_line(verdict.detail) or "(line " in words):
        return f"its card points at a line and names none: {words}"
    if "program did nothing" in words and TRACEBACK in verdict.detail:
        return f"its card says of a program that raised that it did nothing: {words}"
    return _of_two_things(verdict, advice.text, missed)


def _of_two_things(verdict: Verdict, text: str, missed: list[str]) -> str:
    """Where the diagnosis and what is beside it are about different errors, or different words."""
    raised = _RAISED.findall(text)
    if raised and TRACEBACK in verdict.detail and raised[0] not in verdict.detail.strip().splitlines()[-1]:
        return f"its diagnosis is of a {raised[0]}, above the traceback of another: {verdict.detail[-120:]}"
    law = " ".join(" ".join(sentence.split()) for sentence in exercises.get(verdict.exercise).text)
    quotes = _QUOTED.findall(text)
    told = [quote for quote in quotes if quote not in law]  # the task's own words, beside the student's
    seen = _QUOTED.findall(" ".join(missed))
    # A list of what is said quotes only the beginning of each.
    if (
        told
        and seen
        and not any(one[:12] in other or other[:12] in one for one, other in product(quotes, seen))
    ):
        return f"its diagnosis quotes “{told[0]}”, and its criteria “{seen[0]}”"
    return ""
