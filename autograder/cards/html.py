"""A verdict as one self-contained fragment of HTML.

The fragment holds no script, no id and no address, so several cards share a page and nothing is fetched.
JupyterLab's sanitiser takes ``<style>``, ``<svg>`` and ``aria-*`` out of a notebook that is not trusted: the
card is a heading, sentences and tables in the right order without them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from autograder.cards import wording
from autograder.cards.readable import block, one_line, paragraph
from autograder.cards.timeline import HALF_WIDTH, WIDTH, Picture, picture
from autograder.cards.traffic import Part, traffic
from autograder.verdict import Criterion, State, Verdict

if TYPE_CHECKING:
    from jinja2 import Template

MOMENTS = 60
"""Moments that a card shows at most, about."""

_SYMBOLS = {State.PASSED: "✓", State.FAILED: "✗", State.NOT_CHECKED: "?"}

# For the untrusted notebook only, where the style sheet is gone: legible on white and on black.
_PLAIN_COLOURS = {State.PASSED: "#2f8f57", State.FAILED: "#c8641a", State.NOT_CHECKED: "#6482c8"}


def card_html(verdict: Verdict) -> str:
    """Show a verdict in JupyterLab, in nbgrader's feedback or on any page; everything is escaped."""
    css, template = templates()
    return template.render(card=_Card.of(verdict), css=css)


@dataclass(frozen=True)
class _Row:
    passed: bool
    word: str
    title: str
    expected: str
    seen: str
    points: str
    weight: str

    @classmethod
    def of(cls, criterion: Criterion) -> _Row:
        earned = criterion.points if criterion.passed else 0.0
        return cls(
            passed=criterion.passed,
            word=wording.CRITERION_WORDS[criterion.passed],
            title=one_line(criterion.title, 160),
            expected=one_line(criterion.expected, 240) or "–",
            seen=one_line(criterion.seen, 240) or "–",
            points=f"{wording.points(earned)} of {wording.points(criterion.points)}",
            weight=wording.points(max(criterion.points, 0.1)),
        )


@dataclass(frozen=True)
class _Moment:
    time: str
    lane: str
    direction: str
    label: str


@dataclass(frozen=True)
class _Part:
    title: str
    label: str
    picture: Picture
    moments: tuple[_Moment, ...]
    left_out: int
    after: int

    @classmethod
    def of(cls, part: Part, width: int) -> _Part:
        title = one_line(part.title, 120)
        drawn = picture(part, width)
        return cls(
            title=title,
            label=f"Traffic over {_kind_of_time(part.simulated)}" + (f", {title}" if title else ""),
            picture=drawn,
            moments=tuple(
                _Moment(
                    f"{moment.t:.3f} s",
                    one_line(moment.lane, 80),
                    wording.direction(moment.direction),
                    one_line(moment.label, 160),
                )
                for moment in part.moments
            ),
            left_out=part.left_out,
            after=part.after,
        )


@dataclass(frozen=True)
class _Card:
    """All that the template prints, as text that is safe to read (the template escapes it for HTML)."""

    state: str
    symbol: str
    colour: str
    label: str
    title: str
    state_words: str
    tally: str
    counted: bool
    score: str
    max_score: str
    unit: str
    score_line: str
    advice: wording.Advice
    criteria: tuple[_Row, ...]
    remarks: tuple[str, ...]
    parts: tuple[_Part, ...]
    directions: tuple[tuple[str, str], ...]
    traffic_notes: str
    time_heading: str
    shown: str
    detail: str
    detail_heading: str
    fine_print: str

    @classmethod
    def of(cls, verdict: Verdict) -> _Card:
        shown = traffic(verdict.timeline, at_most=MOMENTS)
        advice = wording.advice(verdict)
        title = one_line(verdict.title or verdict.exercise, 160)
        state_words = wording.STATE_WORDS[verdict.state]
        used = {moment.direction for part in shown.parts for moment in part.moments}
        width = WIDTH if len(shown.parts) <= 2 else HALF_WIDTH
        count = sum(len(part.moments) for part in shown.parts)
        return cls(
            state=verdict.state.value,
            symbol=_SYMBOLS[verdict.state],
            colour=_PLAIN_COLOURS[verdict.state],
            label=f"{title}: {state_words}, {wording.score_line(verdict)}",
            title=title,
            state_words=state_words,
            tally=wording.tally(verdict),
            counted=verdict.state is not State.NOT_CHECKED,
            score=wording.points(verdict.score),
            max_score=wording.points(verdict.max_score),
            unit="point" if verdict.max_score == 1 else "points",
            score_line=wording.score_line(verdict),
            advice=wording.Advice(
                advice.heading, paragraph(advice.text, 1200), paragraph(advice.next_step, 1200)
            ),
            criteria=tuple(_Row.of(criterion) for criterion in verdict.criteria),
            remarks=tuple(paragraph(remark, 600) for remark in verdict.remarks),
            parts=tuple(_Part.of(part, width) for part in shown.parts),
            directions=tuple(item for item in wording.DIRECTION_WORDS.items() if item[0] in used),
            traffic_notes=wording.traffic_notes(shown),
            time_heading=_kind_of_time(all(part.simulated for part in shown.parts)).capitalize(),
            shown=f"{count} {'moment' if count == 1 else 'moments'}",
            detail="\n".join(block(verdict.detail, max_lines=120, max_columns=400)),
            detail_heading=one_line(wording.detail_heading(verdict.detail), 160),
            fine_print=one_line(" · ".join(wording.fine_print(verdict)), 200),
        )


def _kind_of_time(simulated: bool) -> str:
    return "simulated time" if simulated else "time"


@cache
def templates() -> tuple[Any, Template]:
    """The style sheet and the card's template, read once."""
    # Imported on first use: a terminal that only prints text need not pay for it.
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("autograder.cards", ""), autoescape=True, undefined=StrictUndefined
    )
    shapes: Any = environment.get_template("shapes.html.j2").module
    environment.globals["shape"] = shapes.shape
    for name in environment.list_templates(extensions=["j2"]):
        environment.get_template(
            name
        )  # also those that the card includes: it would compile them when it is shown
    css = (files("autograder.cards") / "card.css").read_text(encoding="utf-8")
    return Markup(css), environment.get_template("card.html.j2")
