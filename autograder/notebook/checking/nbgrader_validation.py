"""Tells nbgrader's Validate how a check went: by the error with which the check cell ends.

If a cell has not earned full marks, Validate shows the error with which the cell ended. Without an error, it shows
"Partial credit; passed some but not all", even if the cell has earned no points at all. So during Validate, a check
without full marks ends with an error that contains the text of the card.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from autograder.cards import card_wording
from autograder.cards.readable_text import one_line, paragraph, wrap

if TYPE_CHECKING:
    from autograder.verdict import Verdict


VALIDATING = "NBGRADER_VALIDATING"
"""The environment variable that nbgrader sets while its Validate button runs the notebook."""
VALIDATE_WIDTH = 76
"""The maximum length of a line in characters, because nbgrader cuts longer ones."""


def is_validating() -> bool:
    """Return True if nbgrader's Validate runs this notebook."""
    return os.environ.get(VALIDATING) == "1"


class NotFullMarksError(Exception):
    """A check did not earn full marks. The exception's text is the message that Validate shows."""

    def __init__(self, verdicts: list[Verdict]) -> None:
        super().__init__("\n".join(_validate_lines(verdicts)))

    def _render_traceback_(self) -> list[str]:
        """Return only the message, because a traceback would not help. IPython calls this."""
        return str(self).splitlines()


_validated: dict[str, Verdict] = {}


def raise_unless_full(verdict: Verdict) -> None:
    """End the check cell with an error whose message Validate shows. If the check has full marks, do nothing.

    Raises:
        NotFullMarksError: The check does not have full marks.
    """
    _validated.pop(verdict.exercise, None)
    _validated[verdict.exercise] = verdict
    if not verdict.passed:
        raise NotFullMarksError(list(_validated.values()))


def _validate_lines(verdicts: list[Verdict]) -> list[str]:
    """Return the lines of the message: the last check in detail, then the total if there are several checks."""
    last = verdicts[-1]
    state = card_wording.STATE_WORDS[last.state]
    lines = wrap(
        f"{one_line(last.title or last.exercise, 120)}: {state}, {card_wording.score_line(last)}",
        VALIDATE_WIDTH,
    )
    for criterion in last.criteria:
        earned = criterion.points if criterion.passed else 0.0
        mark = "[x]" if criterion.passed else "[ ]"
        text = f"{one_line(criterion.title, 120)} ({card_wording.points_of(earned, criterion.points)})"
        lines += wrap(text, VALIDATE_WIDTH, f"  {mark} ", "      ")
    advice = card_wording.advice(last)
    lines += wrap(paragraph(f"{advice.text} {advice.next_step}", 600), VALIDATE_WIDTH)
    if len(verdicts) > 1:
        score, possible = sum(one.score for one in verdicts), sum(one.max_score for one in verdicts)
        lines.append(f"The checks of this notebook so far: {card_wording.points_of(score, possible)}.")
    lines.append(f'The card of this check is below the cell with check("{last.exercise}", …).')
    return lines
