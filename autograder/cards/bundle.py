"""A verdict as the MIME bundle that a notebook displays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.cards.html import card_html, templates, waiting_html
from autograder.cards.text import card_text

if TYPE_CHECKING:
    from autograder.cards.solution import Solution
    from autograder.verdict import Verdict


def mimebundle(
    verdict: Verdict,
    *,
    before: float | None = None,
    notice: str = "",
    solution: Solution | None = None,
    short: bool = False,
) -> dict[str, str]:
    """The card for ``display(..., raw=True)``: HTML for the browser, text for what shows no HTML.

    Args:
        verdict: What the judge found.
        before: The points of the try before this one, where there was one.
        notice: Why the card is out of date; it is then dimmed. Empty for one that is not.
        solution: The reference solution, which is shown with full marks only.
        short: Leave out all but the points, what happened and what to do next.
    """
    return {
        "text/html": card_html(
            verdict, before=before, notice=notice, solution=solution, short=short, buttons=True
        ),
        "text/plain": card_text(verdict, before=before, notice=notice, solution=solution, short=short),
    }


def waiting_bundle(title: str, doing: str) -> dict[str, str]:
    """The placeholder for a card that is not there yet.

    Args:
        title: The exercise.
        doing: What goes on.
    """
    return {"text/html": waiting_html(title, doing), "text/plain": f"{title}: {doing}"}


def prepare() -> None:
    """Read what the first card would otherwise wait for: about 40 ms."""
    templates()
