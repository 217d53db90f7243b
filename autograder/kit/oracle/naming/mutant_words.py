"""The sentences for what a mutant does: one table, from the operator to the words on a card.

They say the effect (*it is as if*), since several mistakes may have it, and never a line of the solution.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder.kit.model import Advice

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.oracle.naming.deltas import Meaning, Mutants


@dataclass(frozen=True)
class Words:
    """The words for one kind of mistake.

    Attributes:
        operator: The name of the operator.
        kind: The beginning of what the operator says it did; empty for whatever it did.
        key: The key of the diagnosis.
        text: What the code does. ``{at}`` is the place, as in *where the task says …*; ``{name}`` is a word or a name
            that the notebook shows.
    """

    operator: str
    key: str
    text: str
    kind: str = ""


_NUMBERS = ("number", "unit", "number_of_another_place")
_LIMIT, _SIGN = "comparison", "sign"
TABLE: Sequence[Words] = msgspec.toml.decode(
    Path(__file__).with_suffix(".toml").read_bytes(), type=dict[str, list[Words]]
)["words"]
"""The words for each operator and the beginning of its kind. Of mutants at one place, the first row is named."""
NEXT = {
    "other_number": "Compare the numbers in your code with the task, and their units.",
    "condition_ignored": "Compare each condition of your code with the task, with the values that the card shows.",
    "other_way_round": "Look at the comparison there, and at what each of the two branches does.",
    "kept_for_ever": "Look at each attribute: when is it set, and when is it set back?",
    "step_missing": "Go through the sentences of the task one by one: which has no line in your code, or a late one?",
    "forgets": "Store it in self, in `__init__` for the first time, and change it only when it changes.",
}
"""The next step for the student, by the key of the diagnosis."""
USUAL = "Read that sentence of the task again, and compare your code with it step by step."
WITHOUT = (
    "Read the task again, and compare your code with it step by step, with the values that the card shows."
)


def is_one_limit(found: Sequence[Meaning]) -> bool:
    """Return True if all that mutants differ in is the number at one place, or whether just this number counts."""
    kinds = {(_is_number(one), one.spot) for one in found}
    return len(kinds) == 1 and all(_is_number(one) or one.operator == _LIMIT for one in found)


def _is_number(one: Meaning) -> bool:
    return one.operator in _NUMBERS and one.value is not None


def are_of_several_kinds(found: Sequence[Meaning]) -> bool:
    """Return True if mutants have several keys, so that a sentence about the whole output says more."""
    return len({words.key for one in found if (words := _words(one))}) > 1


def advice(found: Sequence[Meaning], mutants: Mutants) -> Advice | None:
    """Return the words for mutants that do the same as a subject; None if they have no single meaning."""
    numbers = [one for one in found if _is_number(one)]
    # A number with another sign is another number, if others do the same.
    spots = {one.spot for one in numbers}
    others = [
        (one, words)
        for one in found
        if (words := _words(one)) and (one.operator, one.spot in spots) != (_SIGN, True)
    ]
    places = {(one.quote or one.place) for one in found}
    if len(places) > 1 and len({_of_a_place(one) for one in found}) > 1:
        return _without_a_place(others) if len(others) == len(found) else None
    if others:
        one, words = min(others, key=lambda pair: TABLE.index(pair[1]))
        return _advice(words.key, words.text.format(at=_at(one), name=one.name), one)
    if numbers:
        return _of_a_number(numbers, mutants)
    return None


def _without_a_place(others: Sequence[tuple[Meaning, Words]]) -> Advice | None:
    """Return words that are true wherever it is, if the mutants are of one kind; None if there are none."""
    free = [(one, words) for one, words in others if "{" not in words.text]
    if not free or len({words.key for _, words in others}) > 1:
        return None
    one, words = min(free, key=lambda pair: TABLE.index(pair[1]))
    return _advice(words.key, words.text, one)


def _of_a_place(one: Meaning) -> tuple[str, str, str]:
    """Return what makes two mutants at different places one meaning: the same words, without a place."""
    words = _words(one)
    return (words.text, one.name, one.quote) if words else (one.operator, str(one.place), one.quote)


def _words(one: Meaning) -> Words | None:
    rows = (row for row in TABLE if row.operator == one.operator and one.kind.startswith(row.kind))
    words = max(rows, key=lambda row: len(row.kind), default=None)
    return None if words is None or ("{name}" in words.text and not one.name) else words


def _at(one: Meaning) -> str:
    if one.quote:
        return f" where the task says “{one.quote}”"
    return f" in `{one.name}`" if one.name.isidentifier() and one.operator != "other_word" else ""


def _advice(key: str, text: str, one: Meaning) -> Advice:
    return Advice(text, NEXT.get(key, USUAL if one.quote else WITHOUT), key=key)


def _of_a_number(found: Sequence[Meaning], mutants: Mutants) -> Advice | None:
    one = found[0]
    if not one.quote and one.right is None:
        return None
    where = f"in “{one.quote}”" if one.quote else f"in the place of {one.right:g}"
    return _advice(
        "other_number", f"It is as if another number stood {where}{_interval(found, mutants)}.", one
    )


def _interval(found: Sequence[Meaning], mutants: Mutants) -> str:
    """Return in words between which numbers the student's lies: those beside it that do something else."""
    values = sorted(one.value for one in found if one.value is not None)
    if not values:
        return ""
    here = [one for one in mutants.meanings if one.spot == found[0].spot and _is_number(one)]
    tried = {value for one in here for value in (one.value, one.right) if value is not None}
    others = tried - set(values)
    below = max((value for value in others if value < values[0]), default=None)
    above = min((value for value in others if value > values[-1]), default=None)
    if below is None and above is None:
        return ""
    if below is None:
        return f" (yours: below {above:g})"
    if above is None:
        return f" (yours: above {below:g})"
    return f" (yours: between {below:g} and {above:g})"
