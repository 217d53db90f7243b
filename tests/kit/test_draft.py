"""Where an exercise's own mistakes stand among the common ones of its recipe."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.draft import OWN, OWN_LATE, Draft
from autograder.kit.evidence import Evidence, Part, Reference
from autograder.kit.model import Advice, Finding, Mistake, mistake

if TYPE_CHECKING:
    from autograder.kit.bench import Bench


class Recipe:
    """A recipe with two common mistakes, one of them twice."""

    roles = ("publisher",)
    ladder = (OWN, *(Mistake(key, lambda _: None) for key in ("hangs", "deaf", "deaf")), OWN_LATE)

    def scenario(self, bench: Bench) -> None:
        """Nothing is done."""

    def seen(self, evidence: Evidence) -> Part:
        """What was seen."""
        return evidence.main

    expected = seen


def keys(draft: Draft[Part]) -> list[str]:
    return [mistake.key for mistake in draft.exercise().mistakes]


def test_own_mistakes_come_in_their_order_at_the_place_that_they_name() -> None:
    draft = Draft("lab.it", "", "", Recipe())
    draft.mistake("late", late=True)(lambda *_: None)
    draft.mistake("usual")(lambda *_: None)
    draft.mistake("one", before="deaf")(lambda *_: None)
    draft.mistake("other", before="deaf")(lambda *_: None)
    assert keys(draft) == ["usual", "hangs", "one", "other", "deaf", "deaf", "late"]
    assert keys(draft) == keys(draft)


def test_a_place_that_the_recipe_has_not_is_an_error() -> None:
    draft = Draft("lab.it", "", "", Recipe())
    draft.mistake("one", before="blind")(lambda *_: None)
    with pytest.raises(ValueError, match="no mistake blind"):
        draft.exercise()


@pytest.mark.parametrize(
    ("found", "text"),
    [(True, "It is True in rolling."), (7, "It is 7 in rolling."), (0, None), (None, None)],
    ids=["true", "a value", "a value that is false", "nothing"],
)
def test_a_text_may_quote_what_was_found(found: object, text: str | None) -> None:
    draft = Draft("lab.it", "", "", Recipe())
    draft.knows("usual", lambda *_: found, "It is {} in {seen.name}.", "")
    advice = draft.exercise().mistakes[0].recognize(Evidence([Part("rolling")], Reference("lab.it", {})))
    assert (advice and advice.text) == text


def test_a_mistake_may_have_words_of_its_own() -> None:
    draft = Draft("lab.it", "", "", Recipe())
    draft.mistake("usual")(lambda seen, _: Advice(f"It has {{braces}} in {seen.name}.", "") if seen else None)
    advice = draft.exercise().mistakes[0].recognize(Evidence([Part("rolling")], Reference("lab.it", {})))
    assert advice == Advice("It has {braces} in rolling.", "")


@pytest.mark.parametrize("text", ["write {x}", "{", "}", "{1} of {}", "{other.name}"])
@pytest.mark.parametrize("place", [0, 1], ids=["what happened", "what to do"])
def test_a_text_that_cannot_be_filled_in_is_refused_when_the_exercise_is_made(text: str, place: int) -> None:
    texts = ["It is {} in {seen.name}.", "{expected.name} {0[1]} {{}}"]
    Draft("lab.it", "", "", Recipe()).knows("usual", lambda *_: True, *texts)
    texts[place] = text
    with pytest.raises(ValueError, match=r"write {} or {seen} or {expected} for a value"):
        Draft("lab.it", "", "", Recipe()).knows("usual", lambda *_: True, *texts)
    with pytest.raises(ValueError, match=r"write {} for a value, and {{ and }} for braces"):
        mistake("usual", lambda _: True, *(["", text] if place else [text, ""]))


def test_criteria_without_points_share_what_the_others_leave() -> None:
    draft = Draft("lab.it", "", "", Recipe(), points=12.0)
    for name in ("first", "second"):
        draft.asks(name, "", lambda _: Finding(True, "", ""))
    draft.criterion("third", "", points=4)(lambda *_: Finding(True, "", ""))
    assert [one.points for one in draft.exercise().criteria] == [4.0, 4.0, 4.0]


@pytest.mark.parametrize(
    ("points", "shares"),
    [(10.0, [3.5, 3.5, 3.0]), (6.0, [2.0, 2.0, 2.0]), (8.0, [3.0, 2.5, 2.5]), (1.75, [0.75, 0.5, 0.5])],
)
def test_shares_are_whole_or_half_points_and_sum_to_the_whole(points: float, shares: list[float]) -> None:
    draft = Draft("lab.it", "", "", Recipe(), points=points)
    for name in ("first", "second", "third"):
        draft.criterion(name, "")(lambda *_: Finding(True, "", ""))
    assert [one.points for one in draft.exercise().criteria] == shares


def test_points_that_leave_nothing_to_share_are_an_error_that_says_what_to_write() -> None:
    draft = Draft("lab.it", "", "", Recipe())
    draft.asks("first", "", lambda _: Finding(True, "", ""), points=10)
    draft.asks("second", "", lambda _: Finding(True, "", ""))
    with pytest.raises(ValueError, match=r"10 of 10 points already: write points=\.\.\. for second"):
        draft.exercise()
