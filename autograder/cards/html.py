"""A verdict as one self-contained fragment of HTML.

The fragment holds no script, no id and no address, so several cards share a page and nothing is fetched.
JupyterLab's sanitiser takes ``<style>``, ``<svg>`` and ``aria-*`` out of a notebook that is not trusted: the
card is a heading, sentences and tables in the right order without them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from autograder.cards import wording
from autograder.cards.differences import Piece, difference
from autograder.cards.readable import block, one_line, paragraph
from autograder.cards.solution import HEADING, OTHER, Solution
from autograder.cards.timeline_layout import HALF_WIDTH, WIDTH, Picture, picture
from autograder.cards.tracebacks import TRACEBACK, Place, place
from autograder.cards.traffic import Part, traffic
from autograder.verdict import Criterion, State, Verdict

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jinja2 import Template

MOMENTS = 80
"""Moments that a card shows at most, about."""
UNFOLDED = 16
"""Lines up to which a traceback is shown at once: longer ones open on demand."""

_SYMBOLS = {State.PASSED: "✓", State.FAILED: "✗", State.NOT_CHECKED: "?"}

# For the untrusted notebook only, where the style sheet is gone: legible on white and on black.
_PLAIN_COLOURS = {State.PASSED: "#2f8f57", State.FAILED: "#c8641a", State.NOT_CHECKED: "#6482c8"}


def card_html(
    verdict: Verdict,
    *,
    before: float | None = None,
    notice: str = "",
    solution: Solution | None = None,
    short: bool = False,
    buttons: bool = False,
) -> str:
    """Show a verdict in JupyterLab, in nbgrader's feedback or on any page; everything is escaped.

    Args:
        verdict: What the judge found.
        before: The points of the try before this one, where there was one.
        notice: Why the card is out of date; it is then dimmed. Empty for one that is not.
        solution: The reference solution, which is shown with full marks only.
        short: Leave out all but the points, what happened and what to do next.
        buttons: With Check, Watch and Next, which only JupyterLab with the course's commands shows.
    """
    css, template = templates()
    card = _Card.of(verdict, before, notice)
    offered = solution.shown_with(verdict) if solution else None
    return template.render(
        card=card.shortened() if short else card,
        css=css,
        solution=None if short else offered,
        solution_heading=HEADING,
        other_way=OTHER,
        buttons=buttons,
    )


def waiting_html(title: str, doing: str) -> str:
    """The placeholder for a card that is not there yet: the exercise, and what goes on."""
    css, _ = templates()
    return _waiting().render(title=one_line(title, 160), doing=one_line(doing, 160), css=css)


@dataclass(frozen=True)
class _Row:
    passed: bool
    word: str
    title: str
    expected: str
    seen: str
    points: str
    weight: str
    difference: tuple[Piece, ...]

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
            difference=tuple(Piece(piece.kind, one_line(piece.text, 200)) for piece in difference(criterion)),
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
    picture: Picture | None
    moments: tuple[_Moment, ...]
    gaps: Mapping[int, int]

    @classmethod
    def of(cls, part: Part, width: int) -> _Part:
        title = one_line(part.title, 120)
        drawn = picture(part, width) if part.is_worth_a_picture else None
        return cls(
            title=title,
            label=(
                "Traffic in its order"
                if part.stands_still
                else f"Traffic over {_kind_of_time(part.simulated)}"
            )
            + (f", {title}" if title else ""),
            picture=drawn,
            moments=tuple(
                _Moment(
                    part.when(index),
                    one_line(moment.lane, 80),
                    wording.direction(moment.direction),
                    one_line(moment.label, 160),
                )
                for index, moment in enumerate(part.moments)
            ),
            gaps=part.gaps,
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
    before: str
    notice: str
    score: str
    max_score: str
    unit: str
    score_line: str
    advice: wording.Advice
    criteria: tuple[_Row, ...]
    remarks: tuple[str, ...]
    parts: tuple[_Part, ...]
    directions: tuple[tuple[str, str], ...]
    stray: bool
    traffic_notes: str
    time_heading: str
    shown: str
    place: Place | None
    detail: str
    unfolded: bool
    detail_heading: str
    fine_print: str

    @classmethod
    def of(cls, verdict: Verdict, before: float | None, notice: str) -> _Card:
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
            label=f"{title}: {state_words}, {wording.score_line(verdict, before)}",
            title=title,
            state_words=state_words,
            tally=wording.tally(verdict),
            counted=verdict.state is not State.NOT_CHECKED,
            before=wording.points_before(verdict, before),
            notice=one_line(notice, 200),
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
            stray=any(moment.stray for part in shown.parts for moment in part.moments),
            traffic_notes=wording.traffic_notes(shown),
            time_heading=_kind_of_time(all(part.simulated for part in shown.parts)).capitalize(),
            shown=f"{count} {'moment' if count == 1 else 'moments'}",
            place=_shown(place(verdict.detail)),
            unfolded=TRACEBACK in verdict.detail and verdict.detail.count("\n") < UNFOLDED,
            detail="\n".join(block(verdict.detail, max_lines=120, max_columns=400)),
            detail_heading=one_line(wording.detail_heading(verdict.detail), 160),
            fine_print=one_line(" · ".join(wording.fine_print(verdict)), 200),
        )

    def shortened(self) -> _Card:
        """The same without what is only looked up."""
        return replace(self, criteria=(), remarks=(), parts=(), detail="", fine_print="")


def _shown(place: Place | None) -> Place | None:
    """A place with texts that are safe to read."""
    return place and Place(one_line(place.where, 120), one_line(place.quote, 200), one_line(place.error, 300))


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
    environment.filters["breakable"] = _breakable
    shapes: Any = environment.get_template("shapes.html.j2").module
    environment.globals["shape"] = shapes.shape
    for name in environment.list_templates(extensions=["j2"]):
        environment.get_template(
            name
        )  # also those that the card includes: it would compile them when it is shown
    css = (files("autograder.cards") / "card.css").read_text(encoding="utf-8")
    return Markup(css), environment.get_template("card.html.j2")


def _waiting() -> Template:
    return templates()[1].environment.get_template("waiting.html.j2")


def _breakable(text: str) -> Any:
    """``text``, escaped, where a line may be broken behind each slash: names of ROS are long."""
    from markupsafe import Markup, escape

    return Markup("/<wbr/>").join(escape(part) for part in text.split("/"))
