"""A verdict as the MIME bundle that a notebook displays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.cards.html import card_html, templates
from autograder.cards.text import card_text

if TYPE_CHECKING:
    from autograder.verdict import Verdict


def mimebundle(verdict: Verdict) -> dict[str, str]:
    """The card for ``display(..., raw=True)``: HTML for the browser, text for what shows no HTML."""
    return {"text/html": card_html(verdict), "text/plain": card_text(verdict)}


def prepare() -> None:
    """Read what the first card would otherwise wait for: about 40 ms."""
    templates()
