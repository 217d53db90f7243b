"""Rules from all that a subject was given to all that it must make of that, and the wrong ones that students follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from autograder.kit.model import Finding

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

View = TypeVar("View")
Given = TypeVar("Given")
Made = TypeVar("Made")


@dataclass(frozen=True)
class Rule(Generic[View, Given, Made]):
    """A rule from all that a subject was given to all that it must make of that.

    Attributes:
        given: What it was given, in order, from what was seen.
        made: What it made of that, in order, so that ``==`` compares it with what the rule makes.
        rule: From all that was given to all that is to be made.
    """

    given: Callable[[View], Sequence[Given]]
    made: Callable[[View], Sequence[Made]]
    rule: Callable[[Sequence[Given]], Sequence[Made]]

    def finding(self, seen: View, expected: View) -> Finding:
        """A criterion: it was given something, and made of it what the rule makes.

        Where it was given nothing, the card says what the reference solution makes, in place of "expected: nothing".
        """
        given, made = self.given(seen), list(self.made(seen))
        if not given:
            usual = self.rule(self.given(expected))
            return Finding(False, f"such as {_in_words(usual)}", _in_words(made))
        due = list(self.rule(given))
        return Finding(made == due, _in_words(due), _in_words(made))

    def taken_for(self, wrong: Callable[[Sequence[Given]], Sequence[Made]]) -> Callable[[View, View], bool]:
        """A mistake: all that it made is what a wrong rule makes, and not what the right one does.

        A subject that stopped on its way is compared as far as it came.
        """

        def recognise(seen: View, _: View) -> bool:
            given, made = self.given(seen), list(self.made(seen))
            so_far = len(made)
            return bool(made) and made == list(wrong(given))[:so_far] != list(self.rule(given))[:so_far]

        return recognise


def _in_words(values: Sequence[object]) -> str:
    return ", ".join(map(str, values)) or "nothing"
