"""Prepares the content of both kinds of card, HTML and text, as strings that are safe to show."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypedDict

from autograder.cards import wording
from autograder.cards.differences import TextPiece, difference
from autograder.cards.readable import block, one_line, paragraph
from autograder.cards.tracebacks import TRACEBACK, TracebackPlace, place
from autograder.cards.traffic import Traffic, traffic

if TYPE_CHECKING:
    from autograder.verdict import CriterionResult, State, Verdict

UNFOLDED = 16
"""A traceback is shown unfolded if it has fewer lines than this."""
SOLUTION_LINES = 120
SOLUTION_COLUMNS = 200
"""The maximum numbers of lines, and of characters in a line, of a cell of the reference solution."""


@dataclass(frozen=True)
class Form:
    """The marks and limits of one kind of card, HTML or text.

    Attributes:
        mark: The text that stands for a part that was cut out.
        nothing: The text that stands for an empty text.
        moments: The approximate maximum number of moments of the traffic.
        lines: The maximum number of lines of a traceback or of output.
        columns: The maximum length of such a line, in characters.
    """

    mark: str
    nothing: str
    moments: int
    lines: int
    columns: int


ON_A_PAGE = Form("…", "–", moments=80, lines=120, columns=400)
IN_A_TERMINAL = Form("...", "-", moments=30, lines=60, columns=240)


@dataclass(frozen=True)
class Solution:
    """The reference solution, which a card offers only with full marks.

    Attributes:
        code: The solution cells, in order.
        why: One or two sentences about why the solution is written this way.
        other_way: The advantage of another way to write it; empty if no other way is worth showing.
        other_code: The code of that other way.
    """

    code: tuple[str, ...]
    why: str
    other_way: str = ""
    other_code: str = ""

    def readable(self) -> Solution:
        """Return the solution with all texts made safe to show."""
        code = tuple(_code(cell) for cell in self.code)
        other_way, other_code = paragraph(self.other_way, 600), _code(self.other_code)
        return Solution(code, paragraph(self.why, 600), other_way, other_code)


class Choices(TypedDict, total=False):
    """Options for how a card is shown.

    Attributes:
        before: The points of the previous check; None if there was none.
        notice: Why the card is out of date, in which case it is dimmed; empty if it is up to date.
        solution: The reference solution, shown only with full marks.
        short: True to show only the points, what happened and what to do next.
    """

    before: float | None
    notice: str
    solution: Solution | None
    short: bool


@dataclass(frozen=True)
class CriterionRow:
    """A criterion as the card shows it, with its points in words and as a fraction of the bar."""

    passed: bool
    word: str
    title: str
    expected: str
    seen: str
    points: str
    unit: str
    weight: str
    difference: tuple[TextPiece, ...]

    @classmethod
    def of(cls, criterion: CriterionResult, form: Form) -> CriterionRow:
        """Return the row of a criterion."""
        earned = criterion.points if criterion.passed else 0.0
        pieces = difference(criterion)
        return cls(
            passed=criterion.passed,
            word=wording.CRITERION_WORDS[criterion.passed],
            title=one_line(criterion.title, 160, mark=form.mark),
            expected=one_line(criterion.expected, 240, mark=form.mark) or form.nothing,
            seen=one_line(criterion.seen, 240, mark=form.mark) or form.nothing,
            points=f"{wording.points(earned)} of {wording.points(criterion.points)}",
            unit=wording.unit(criterion.points),
            weight=wording.points(max(criterion.points, 0.1)),
            difference=tuple(TextPiece(one.kind, one_line(one.text, 200, mark=form.mark)) for one in pieces),
        )


@dataclass(frozen=True)
class Card:
    """The content of a card, made from an :class:`autograder.verdict.Verdict`.

    Attributes:
        score_line: The points in words.
        before: The points of the previous check, if they were different; otherwise empty.
        notice: Why the card is out of date; empty if it is up to date.
        traffic: The traffic on the wire. Its texts come from the subject.
        traffic_notes: Which parts of the traffic are left out.
        place: The student's line in which the traceback ends; None if there is none.
        unfolded: True if the detail is short enough to be shown unfolded.
        facts: The facts that a student should quote in a question.
        solution: The reference solution; None if it is not shown.
    """

    state: State
    title: str
    state_words: str
    tally: str
    score_line: str
    before: str
    score: str
    max_score: str
    unit: str
    notice: str
    advice: wording.AdviceBlock
    place: TracebackPlace | None
    criteria: tuple[CriterionRow, ...]
    remarks: tuple[str, ...]
    traffic: Traffic
    traffic_notes: str
    detail_heading: str
    detail: tuple[str, ...]
    unfolded: bool
    facts: tuple[str, ...]
    solution: Solution | None

    @classmethod
    def of(
        cls,
        verdict: Verdict,
        form: Form,
        *,
        before: float | None = None,
        notice: str = "",
        solution: Solution | None = None,
        short: bool = False,
    ) -> Card:
        """Return the content of a verdict's card, in one form. For the other arguments see :class:`Choices`."""
        mark = form.mark
        advice = wording.advice(verdict)
        shown = traffic(verdict.timeline, at_most=form.moments)
        detail = verdict.detail if verdict.detail.strip() else ""
        card = cls(
            state=verdict.state,
            title=one_line(verdict.title or verdict.exercise, 160, mark=mark),
            state_words=wording.STATE_WORDS[verdict.state],
            tally=wording.tally(verdict),
            score_line=wording.score_line(verdict, before),
            before=wording.points_before(verdict, before),
            score=wording.points(verdict.score),
            max_score=wording.points(verdict.max_score),
            unit=wording.unit(verdict.max_score),
            notice=one_line(notice, 200, mark=mark),
            advice=wording.AdviceBlock(
                advice.heading,
                paragraph(advice.text, 1200, mark=mark),
                paragraph(advice.next_step, 1200, mark=mark),
            ),
            place=_readable(place(verdict.detail), mark),
            criteria=tuple(CriterionRow.of(criterion, form) for criterion in verdict.criteria),
            remarks=tuple(paragraph(remark, 600, mark=mark) for remark in verdict.remarks),
            traffic=shown,
            traffic_notes=wording.traffic_notes(shown),
            detail_heading=one_line(wording.detail_heading(detail), 160, mark=mark),
            detail=tuple(block(detail, max_lines=form.lines, max_columns=form.columns, mark=mark))
            if detail
            else (),
            unfolded=TRACEBACK in detail and detail.count("\n") < UNFOLDED,
            facts=tuple(wording.fine_print(verdict)),
            solution=solution.readable() if solution and verdict.passed else None,
        )
        return card._shortened() if short else card

    def _shortened(self) -> Card:
        return replace(self, criteria=(), remarks=(), traffic=Traffic(()), detail=(), facts=(), solution=None)


def _readable(found: TracebackPlace | None, mark: str) -> TracebackPlace | None:
    if found is None:
        return None
    texts = (found.where, 120), (found.quote, 200), (found.error, 300)
    return TracebackPlace(*(one_line(text, limit, mark=mark) for text, limit in texts))


def _code(text: str) -> str:
    return "\n".join(block(text, max_lines=SOLUTION_LINES, max_columns=SOLUTION_COLUMNS)) if text else ""
