"""The reference solution as a card offers it: folded up, and with full marks only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards.readable import block, paragraph

if TYPE_CHECKING:
    from autograder.verdict import Verdict

HEADING = "The reference solution, and why it is written so"
"""Of what is folded up."""
OTHER = "Another way"
"""The heading of an alternative."""
MAX_LINES = 120
MAX_COLUMNS = 200
"""Lines and columns of a piece of code that are shown."""


@dataclass(frozen=True)
class Solution:
    """A reference solution.

    Attributes:
        code: The solution cells, in their order.
        why: Why it is written so, in one or two sentences.
        other_way: What another way is good for; empty where none is worth a look.
        other_code: That way.
    """

    code: tuple[str, ...]
    why: str
    other_way: str = ""
    other_code: str = ""

    def shown_with(self, verdict: Verdict) -> Solution | None:
        """The same as texts that are safe to read; None where the verdict has not full marks."""
        if not verdict.passed:
            return None
        return Solution(
            tuple(_code(cell) for cell in self.code),
            paragraph(self.why, 600),
            paragraph(self.other_way, 600),
            _code(self.other_code),
        )


def _code(text: str) -> str:
    return "\n".join(block(text, max_lines=MAX_LINES, max_columns=MAX_COLUMNS)) if text else ""
