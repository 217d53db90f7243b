"""Renders the card of a verdict as HTML, which a notebook displays.

The HTML of a card contains no script, no id and no URL, so several cards can share a page and nothing is loaded. If a
notebook is not trusted, JupyterLab's sanitizer removes ``<style>``, ``<svg>`` and ``aria-*`` from the card. The card
then still consists of a heading, sentences and tables in the right order.

Other parts of the course take the templates of their pages from :func:`page_templates`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Unpack

from autograder.cards import card_wording
from autograder.cards.card_content import ON_A_PAGE, Card, Choices
from autograder.cards.readable_text import one_line
from autograder.cards.text_rendering import card_text
from autograder.cards.timeline_layout import HALF_WIDTH, WIDTH, Picture, picture
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jinja2 import Environment

    from autograder.cards.card_traffic import TrafficPart
    from autograder.verdict import Verdict


_SYMBOLS = {State.PASSED: "✓", State.FAILED: "✗", State.NOT_CHECKED: "?", State.CHECKING: "…"}

# The colors below are used only in an untrusted notebook, which has no style sheet. They are legible on white and on
# black.
_PLAIN_COLORS = {
    State.PASSED: "#2f8f57",
    State.FAILED: "#c8641a",
    State.NOT_CHECKED: "#6482c8",
    State.CHECKING: "#6482c8",
}


def card_bundle(verdict: Verdict, **choices: Unpack[Choices]) -> dict[str, str]:
    """Return the card as ``display(..., raw=True)`` takes it: HTML for browsers, text for other front ends."""
    html, text = card_html(verdict, buttons=True, **choices), card_text(verdict, **choices)
    return {"text/html": html, "text/plain": text}


def waiting_bundle(title: str, doing: str, *, over: bool = False) -> dict[str, str]:
    """Return the placeholder for a card without a result.

    Args:
        doing: The current step, or why there is no result.
        over: True if the check has ended. If False, JupyterLab changes the card as soon as the kernel ends.
    """
    title, doing = one_line(title, 160), one_line(doing, 600)
    html = templates().get_template("waiting.html.j2").render(title=title, doing=doing, over=over)
    return {"text/html": html, "text/plain": f"{title}: {doing}"}


def card_html(verdict: Verdict, *, buttons: bool = False, **choices: Unpack[Choices]) -> str:
    """Return a verdict as HTML, with all texts escaped: for JupyterLab, nbgrader's feedback or any other page.

    Args:
        buttons: True to add the buttons, such as Check, Watch and Next, which appear only in JupyterLab with the
            course's commands.
    """
    card = Card.of(verdict, ON_A_PAGE, **choices)
    width = WIDTH if len(card.traffic.parts) <= 2 else HALF_WIDTH
    template = templates().get_template("card.html.j2")
    return template.render(
        card=card,
        parts=[_Part.of(part, width) for part in card.traffic.parts],
        moments=[moment for part in card.traffic.parts for moment in part.moments],
        symbols=_SYMBOLS,
        color=_PLAIN_COLORS[card.state],
        facts=one_line(" · ".join(card.facts), 200),
        buttons=buttons,
    )


@dataclass(frozen=True)
class _Part:
    """A part of the traffic: its picture, and a row of the table for each moment (time, lane, direction, words)."""

    title: str
    label: str
    simulated: bool
    picture: Picture | None
    moments: tuple[tuple[str, str, str, str], ...]
    gaps: Mapping[int, int]

    @classmethod
    def of(cls, part: TrafficPart, width: int) -> _Part:
        title = one_line(part.title, 120)
        label = "Traffic in its order" if part.stands_still else f"Traffic over {part.kind_of_time}"
        return cls(
            title=title,
            label=label + (f", {title}" if title else ""),
            simulated=part.simulated,
            picture=picture(part, width) if part.is_worth_a_picture else None,
            moments=tuple(
                (
                    part.when(index),
                    one_line(moment.lane, 80),
                    card_wording.direction(moment.direction),
                    one_line(moment.label, 160),
                )
                for index, moment in enumerate(part.moments)
            ),
            gaps=part.gaps,
        )


@cache
def templates() -> Environment:
    """Return the templates of cards and certificates. They are read only once, which takes about 40 ms."""
    from markupsafe import Markup

    environment = page_templates("autograder.cards", trimmed=False)
    environment.filters["breakable"] = _breakable
    shapes: Any = environment.get_template("shapes.html.j2").module
    css = (files("autograder.cards") / "card.css").read_text(encoding="utf-8")
    environment.globals |= {"shape": shapes.shape, "wording": card_wording, "css": Markup(css)}
    for name in environment.list_templates(extensions=["j2"]):
        # Compile the included templates now, so that the first card does not have to wait for that.
        environment.get_template(name)
    return environment


def page_templates(package: str, *, trimmed: bool = True) -> Environment:
    """Return the templates in the folder of a package. Values are escaped, and an undefined name is an error.

    Args:
        package: The name of the package, such as ``"autograder.student"``.
        trimmed: True to remove the line breaks and indents that only the tags of the templates need.
    """
    # Imported at the first use, because a terminal that only prints text does not need it.
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader(package, ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=trimmed,
        lstrip_blocks=trimmed,
    )


def _breakable(text: str) -> Any:
    """Return ``text`` escaped, with a possible line break after each slash, because ROS names are long."""
    from markupsafe import Markup, escape

    return Markup("/<wbr/>").join(escape(part) for part in text.split("/"))
