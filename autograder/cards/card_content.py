"""Prepares the content of both kinds of card, HTML and text, as strings that are safe to show.

If a text differs a little from the expected text, the content also contains the characters that are missing or too
much, because two long texts look equal if only a comma is missing.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, TypedDict

import re2

from autograder.cards import card_wording
from autograder.cards.card_traffic import Traffic, traffic
from autograder.cards.readable_text import TRACEBACK, TracebackLine, block, one_line, paragraph, students_line
from autograder.cards.way_layout import SHOWN, WayPicture, way_picture
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.verdict import CriterionResult, Verdict


_UNFOLDED = 16
"""A traceback is shown unfolded if it has fewer lines than this."""
_SOLUTION_LINES = 120
_SOLUTION_COLUMNS = 200
"""The maximum numbers of lines, and of characters in a line, of a cell of the reference solution."""
_TODO = "# TODO: "
"""The beginning of the line that asks for a solution. Whether a student leaves it there is not a change of the code."""


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
    """The reference solution, for a card with full marks, or of a student who has opened the worked solution.

    Attributes:
        code: The solution cells, in order.
        why: One or two sentences about why the solution is written this way.
        other_way: The advantage of another way to write it; empty if no other way is worth showing.
        other_code: The code of that other way.
        broken: If students repair code, the broken code for each solution cell; empty for a cell without broken code.
        own: The student's own code for each of these cells.
    """

    code: tuple[str, ...]
    why: str = ""
    other_way: str = ""
    other_code: str = ""
    broken: tuple[str, ...] = ()
    own: tuple[str, ...] = ()

    def readable(self) -> Solution:
        """Return the solution with all texts made safe to show."""
        code, broken, own = (tuple(map(_code, cells)) for cells in (self.code, self.broken, self.own))
        other_way, other_code = paragraph(self.other_way, 600), _code(self.other_code)
        return Solution(code, paragraph(self.why, 600), other_way, other_code, broken, own)

    @property
    def changes(self) -> dict[str, list[str]]:
        """How our solution and the student's own change the broken code: lines of a diff, by whose they are."""
        found = {card_wording.OUR_CHANGE: self.code, card_wording.OWN_CHANGE: self.own}
        told = {
            whose: [
                line
                for broken, cell in zip(self.broken, cells, strict=False)
                if broken and cell
                for line in _changed_lines(broken, cell)
            ]
            for whose, cells in found.items()
        }
        return {whose: lines for whose, lines in told.items() if lines}


class Choices(TypedDict, total=False):
    """Options for how a card is shown.

    Attributes:
        before: The points of the previous check; None if there was none.
        notice: Why the card is out of date, in which case it is dimmed; empty if it is up to date.
        solution: The reference solution, which the card shows; None to show none.
        offers_solution: True to offer the worked solution by a button.
        short: True to show only the points, what happened and what to do next.
    """

    before: float | None
    notice: str
    solution: Solution | None
    offers_solution: bool
    short: bool


_STATES = {True: State.PASSED, False: State.FAILED, None: State.CHECKING}
"""The state of a criterion, by whether it is met."""


@dataclass(frozen=True)
class CriterionRow:
    """A criterion as the card shows it, with its points in words and as a fraction of the bar."""

    passed: bool
    state: State
    word: str
    title: str
    expected: str
    seen: str
    points: str
    possible: str
    unit: str
    weight: str
    difference: tuple[TextPiece, ...]
    counts: str

    @classmethod
    def of(cls, criterion: CriterionResult, form: Form) -> CriterionRow:
        """Return the row of a criterion."""
        earned = criterion.points if criterion.passed else 0.0
        pieces = difference(criterion)
        return cls(
            passed=bool(criterion.passed),
            state=_STATES[criterion.passed],
            word=card_wording.CRITERION_WORDS[criterion.passed],
            title=one_line(criterion.title, 160, mark=form.mark),
            expected=one_line(criterion.expected, 240, mark=form.mark) or form.nothing,
            seen=one_line(criterion.seen, 240, mark=form.mark) or form.nothing,
            points=f"{card_wording.points(earned)} of {card_wording.points(criterion.points)}",
            possible=f"{card_wording.points(criterion.points)} {card_wording.unit(criterion.points)}",
            unit=card_wording.unit(criterion.points),
            weight=card_wording.points(max(criterion.points, 0.1)),
            difference=tuple(TextPiece(one.kind, one_line(one.text, 200, mark=form.mark)) for one in pieces),
            counts=one_line(criterion.counts, 400, mark=form.mark),
        )


@dataclass(frozen=True)
class Card:
    """The content of a card, made from an :class:`autograder.verdict.Verdict`.

    Attributes:
        score_line: The points in words.
        before: The points of the previous check, if they were different; otherwise empty.
        notice: Why the card is out of date; empty if it is up to date.
        ways: The ways of the robot.
        traffic: The traffic on the wire. Its texts come from the subject.
        traffic_notes: Which parts of the traffic are left out.
        counts: What else counts for the exercise as a whole, and what is not graded.
        nothing_seen: True to list what is asked instead of what was seen, because nothing was.
        place: The student's line in which the traceback ends; None if there is none.
        unfolded: True if the detail is short enough to be shown unfolded.
        facts: The facts that a student should quote in a question.
        solution: The reference solution; None if it is not shown.
        offers_solution: True if a button opens the solution.
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
    advice: card_wording.AdviceBlock
    place: TracebackLine | None
    criteria: tuple[CriterionRow, ...]
    counts: str
    nothing_seen: bool
    remarks: tuple[str, ...]
    ways: tuple[WayPicture, ...]
    traffic: Traffic
    traffic_notes: str
    detail_heading: str
    detail: tuple[str, ...]
    unfolded: bool
    facts: tuple[str, ...]
    solution: Solution | None
    offers_solution: bool

    @classmethod
    def of(
        cls,
        verdict: Verdict,
        form: Form,
        *,
        before: float | None = None,
        notice: str = "",
        solution: Solution | None = None,
        offers_solution: bool = False,
        short: bool = False,
    ) -> Card:
        """Return the content of a verdict's card for one form. For the other arguments see :class:`Choices`."""
        # Each text may quote a student's output of any length, so it is cut to what fits on a card.
        mark = form.mark
        advice = card_wording.advice(verdict)
        shown = traffic(verdict.timeline, at_most=form.moments)
        detail = verdict.detail if verdict.detail.strip() else ""
        card = cls(
            state=verdict.state,
            title=one_line(verdict.title or verdict.exercise, 160, mark=mark),
            state_words=card_wording.STATE_WORDS[verdict.state],
            tally=card_wording.tally(verdict),
            score_line=card_wording.score_line(verdict, before),
            before=card_wording.points_before(verdict, before),
            score=card_wording.points(verdict.score),
            max_score=card_wording.points(verdict.max_score),
            unit=card_wording.unit(verdict.max_score),
            notice=one_line(notice, 200, mark=mark),
            advice=card_wording.AdviceBlock(
                advice.heading,
                paragraph(advice.text, 1200, mark=mark),
                paragraph(advice.next_step, 1200, mark=mark),
            ),
            place=_readable(students_line(verdict.detail, advice.text), mark),
            criteria=tuple(CriterionRow.of(criterion, form) for criterion in verdict.criteria),
            counts=one_line(verdict.counts, 1200, mark=mark),
            nothing_seen=verdict.nothing_seen,
            remarks=tuple(paragraph(remark, 600, mark=mark) for remark in verdict.remarks),
            ways=tuple(map(way_picture, verdict.ways[:SHOWN])),
            traffic=shown,
            traffic_notes=card_wording.traffic_notes(shown),
            detail_heading=one_line(card_wording.detail_heading(detail), 160, mark=mark),
            detail=tuple(block(detail, max_lines=form.lines, max_columns=form.columns, mark=mark))
            if detail
            else (),
            unfolded=TRACEBACK in detail and detail.count("\n") < _UNFOLDED,
            facts=tuple(card_wording.fine_print(verdict)),
            # Until the pass of a bug hunt, nothing tells the cause.
            solution=solution.readable() if solution and (verdict.passed or not solution.broken) else None,
            offers_solution=offers_solution,
        )
        return card._shortened() if short else card

    def _shortened(self) -> Card:
        return replace(
            self,
            criteria=(),
            counts="",
            remarks=(),
            ways=(),
            traffic=Traffic(()),
            detail=(),
            facts=(),
            solution=None,
            offers_solution=False,
        )


def _readable(found: TracebackLine | None, mark: str) -> TracebackLine | None:
    if found is None:
        return None
    texts = (found.where, 120), (found.quote, 200), (found.error, 300)
    return TracebackLine(*(one_line(text, limit, mark=mark) for text, limit in texts))


def _changed_lines(broken: str, repaired: str) -> list[str]:
    """Return the lines of a diff without its heading; ``…`` stands for equal lines that are left out."""
    before, after = (
        [line.rstrip() for line in text.strip().split("\n") if not line.lstrip().startswith(_TODO)]
        for text in (broken, repaired)
    )
    lines = list(difflib.unified_diff(before, after, n=1, lineterm=""))[3:]
    return ["…" if line.startswith("@@") else line for line in lines]


def _code(text: str) -> str:
    return "\n".join(block(text, max_lines=_SOLUTION_LINES, max_columns=_SOLUTION_COLUMNS)) if text else ""


_MIN_SIMILARITY = 0.5
"""The minimum similarity of two texts, from 0 to 1. If they are less similar, showing their difference would not help.
"""
_LONGEST_COMPARED = 120
"""The maximum length of a compared text, in characters, because the time grows with the square of the length."""
_QUOTED = re2.compile("“([^“”]*)”")
_BLANK = "␣"
_ANY_NUMBER = "N"
"""The letter that stands for any whole number in an expected text."""


class _DiffTag(StrEnum):
    """The kind of a piece of text: equal, missing, or too much."""

    SAME = "same"
    MISSING = "missing"
    EXTRA = "extra"


@dataclass(frozen=True)
class TextPiece:
    """A sequence of characters, all equal in both texts, all missing, or all too much."""

    kind: _DiffTag
    text: str

    @property
    def marked(self) -> str:
        """Return the text with marks that show its kind without color: ``[missing]``, ``{too much}``."""
        if self.kind is _DiffTag.SAME:
            return self.text
        text = self.text.replace(" ", _BLANK)
        return f"[{text}]" if self.kind is _DiffTag.MISSING else f"{{{text}}}"


def difference(criterion: CriterionResult) -> tuple[TextPiece, ...]:
    """Return the difference between the first quoted text that was seen and the first one that was expected.

    The result is empty if the criterion is met or if one side has no quoted text. It is also empty if the two texts are
    equal, too long, or too different for a comparison to help.
    """
    if criterion.passed:
        return ()
    expected, seen = _QUOTED.search(criterion.expected), _QUOTED.search(criterion.seen)
    if expected is None or seen is None:
        return ()
    return _compared(expected[1], seen[1])


def marked(pieces: Iterable[TextPiece]) -> str:
    """Return all pieces as one text, with brackets around what is missing: ``"Hello[,] world[!] 0"``."""
    return "".join(piece.marked for piece in pieces)


def _compared(expected: str, seen: str) -> tuple[TextPiece, ...]:
    if expected == seen or max(len(expected), len(seen)) > _LONGEST_COMPARED:
        return ()
    matcher = difflib.SequenceMatcher(None, expected, seen, autojunk=False)
    if matcher.ratio() < _MIN_SIMILARITY:
        return ()
    found = []
    for operation, a1, a2, b1, b2 in matcher.get_opcodes():
        fills_in = expected[a1:a2] == _ANY_NUMBER and seen[b1:b2].isdigit()
        if operation == "equal" or fills_in:
            found.append(TextPiece(_DiffTag.SAME, seen[b1:b2]))
            continue
        if operation in ("delete", "replace"):
            found.append(TextPiece(_DiffTag.MISSING, expected[a1:a2]))
        if operation in ("insert", "replace"):
            found.append(TextPiece(_DiffTag.EXTRA, seen[b1:b2]))
    return tuple(found)
