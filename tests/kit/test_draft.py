"""Where an exercise's own mistakes stand among the common ones of its recipe."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.draft import OWN, OWN_LATE, Draft
from autograder.kit.model import Bench, Mistake

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part


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
    draft.mistake("late", late=True)(lambda *_: False)
    draft.mistake("usual")(lambda *_: False)
    draft.mistake("one", before="deaf")(lambda *_: False)
    draft.mistake("other", before="deaf")(lambda *_: False)
    assert keys(draft) == ["usual", "hangs", "one", "other", "deaf", "deaf", "late"]
    assert keys(draft) == keys(draft)


def test_a_place_that_the_recipe_has_not_is_an_error() -> None:
    draft = Draft("lab.it", "", "", Recipe())
    draft.mistake("one", before="blind")(lambda *_: False)
    with pytest.raises(ValueError, match="no mistake blind"):
        draft.exercise()
