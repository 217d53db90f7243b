"""A verdict as plain text: for terminals, for logs and to be read aloud.

The twin says what the HTML card says, in the same words and order. Its own marks are ASCII only, so that it
survives any terminal; every line stands by itself, without columns that a screen reader would tear apart.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.cards import wording
from autograder.cards.differences import difference, marked
from autograder.cards.readable import block, one_line, paragraph, wrap
from autograder.cards.readable import width as columns
from autograder.cards.solution import HEADING, OTHER
from autograder.cards.tracebacks import place
from autograder.cards.traffic import Part, Traffic, traffic
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.cards.solution import Solution
    from autograder.verdict import Criterion, Verdict

MOMENTS = 30
"""Moments that the text shows at most, about."""

_MARK = "..."
_ARROWS = {"from_subject": "-->", "to_subject": "<--", "expected": "..>"}
_COLOURS = {State.PASSED: "32", State.FAILED: "33", State.NOT_CHECKED: "34"}
_NARROWEST = 40


def card_text(
    verdict: Verdict,
    *,
    width: int = 88,
    color: bool = False,
    before: float | None = None,
    notice: str = "",
    solution: Solution | None = None,
    short: bool = False,
) -> str:
    """Show a verdict in a terminal.

    Args:
        verdict: What the judge found.
        width: Columns of a line; 40 at least. Lines of a traceback may be longer.
        color: Whether to add ANSI codes (bold, and a colour for the state); they carry no meaning.
        before: The points of the try before this one, where there was one.
        notice: Why the card is out of date; empty for one that is not.
        solution: The reference solution, which is shown with full marks only.
        short: Leave out all but the points, what happened and what to do next.

    Returns:
        Lines without a newline at the end.
    """
    offered = solution.shown_with(verdict) if solution else None
    writer = _Writer(max(width, _NARROWEST), color, before, notice, offered)
    return "\n".join(writer.begin(verdict) if short else writer.card(verdict))


class _Writer:
    def __init__(
        self, width: int, color: bool, before: float | None, notice: str, solution: Solution | None = None
    ) -> None:
        self._width = width
        self._color = color
        self._before = before
        self._notice = notice
        self._solution = solution

    def begin(self, verdict: Verdict) -> Iterator[str]:
        yield from self._head(verdict)
        yield from self._advice(verdict)

    def card(self, verdict: Verdict) -> Iterator[str]:
        yield from self.begin(verdict)
        if verdict.criteria:
            yield ""
            yield self._heading("Criteria")
            for criterion in verdict.criteria:
                yield from self._criterion(criterion)
        if verdict.remarks:
            yield ""
            yield self._heading("Worth a word (costs no points)")
            for remark in verdict.remarks:
                yield from self._wrapped(paragraph(remark, 600, mark=_MARK), "  - ", "    ")
        yield from self._traffic(traffic(verdict.timeline, at_most=MOMENTS))
        yield from self._detail(verdict.detail)
        if self._solution:
            yield from self._offered(self._solution)
        yield ""
        fine_print = one_line(", ".join(wording.fine_print(verdict)), 200, mark=_MARK)
        yield from self._wrapped(f"({fine_print})", "", " ")

    def _head(self, verdict: Verdict) -> Iterator[str]:
        title = one_line(verdict.title or verdict.exercise, 160, mark=_MARK)
        yield from (self._styled(line, "1") for line in self._wrapped(title))
        tally = wording.tally(verdict)
        state = wording.STATE_WORDS[verdict.state].upper()
        how = f"{state}: {wording.score_line(verdict, self._before)}" + (f", {tally}" if tally else "")
        first, *rest = self._wrapped(how, "", "  ")
        yield self._styled(state, f"1;{_COLOURS[verdict.state]}") + first.removeprefix(state)
        yield from rest
        yield "-" * min(self._width, max(columns(how), columns(title)))
        if self._notice:
            yield from self._wrapped(one_line(self._notice, 200, mark=_MARK))

    def _advice(self, verdict: Verdict) -> Iterator[str]:
        advice = wording.advice(verdict)
        if advice.heading:
            yield self._heading(advice.heading)
        yield from self._wrapped(paragraph(advice.text, 1200, mark=_MARK), "  " if advice.heading else "")
        found = place(verdict.detail)
        if found:
            where = f"{one_line(found.where, 120, mark=_MARK)}: {one_line(found.quote, 200, mark=_MARK)}"
            yield from self._wrapped(where.rstrip(": "), "  ", "    ")
        if advice.next_step:
            yield ""
            yield self._heading("What to do next")
            yield from self._wrapped(paragraph(advice.next_step, 1200, mark=_MARK), "  > ", "    ")

    def _criterion(self, criterion: Criterion) -> Iterator[str]:
        word = wording.CRITERION_WORDS[criterion.passed]
        earned = criterion.points if criterion.passed else 0.0
        line = f"{one_line(criterion.title, 160, mark=_MARK)} ({wording.points_of(earned, criterion.points)})"
        badge = self._styled(f"[{word}]", _COLOURS[State.PASSED if criterion.passed else State.FAILED])
        first, *rest = self._wrapped(line, " " * (len(word) + 5), "    ")
        yield f"  {badge} {first.lstrip()}"
        yield from rest
        if not criterion.passed:
            yield from self._named("expected", criterion.expected)
        yield from self._named("seen", criterion.seen)
        if pieces := difference(criterion):
            yield from self._named(wording.DIFFERENCE, marked(pieces))

    def _named(self, name: str, value: str) -> Iterator[str]:
        text = one_line(value, 240, mark=_MARK) or "-"
        yield from self._wrapped(text, f"    {name}: ", "      ")

    def _traffic(self, shown: Traffic) -> Iterator[str]:
        if not shown.parts:
            return
        yield ""
        missed = any(moment.direction == "expected" for part in shown.parts for moment in part.moments)
        ghost = f"..> {wording.DIRECTION_WORDS['expected']}, " if missed else ""
        heading = f"What was on the wire (--> from your code, <-- to your code, {ghost}* note)"
        yield from (self._heading(line) for line in self._wrapped(heading))
        for part in shown.parts:
            yield from self._part(part)
        notes = wording.traffic_notes(shown)
        if notes:
            yield from self._wrapped(notes, "  ")

    def _part(self, part: Part) -> Iterator[str]:
        if part.title:
            yield from self._wrapped(one_line(part.title, 120, mark=_MARK) + ":", "  ", "  ")
        lanes = {lane: one_line(lane, self._width * 3 // 8, mark=_MARK) for lane in part.lanes}
        lane_columns = max(map(columns, lanes.values()))
        for index, moment in enumerate(part.moments):
            arrow = _ARROWS.get(moment.direction, " * ")
            lane = lanes[moment.lane]
            padding = " " * (lane_columns - columns(lane))
            start = f"  {part.when(index):>11}  {lane}{padding} {arrow} "
            label = one_line(moment.label, self._width - columns(start), mark=_MARK)
            yield from (line.rstrip() for line in self._wrapped(label, start, " " * columns(start)))
            if index in part.gaps:
                yield f"            {_MARK} {part.gaps[index]} more left out here"

    def _detail(self, detail: str) -> Iterator[str]:
        if not detail.strip():
            return
        yield ""
        yield from self._wrapped(one_line(wording.detail_heading(detail), 160, mark=_MARK))
        for line in block(detail, max_lines=60, max_columns=240, mark=_MARK):
            yield f"  | {line}".rstrip()

    def _offered(self, solution: Solution) -> Iterator[str]:
        yield ""
        yield self._heading(HEADING)
        yield from self._wrapped(solution.why, "  ")
        for code in solution.code:
            yield ""
            yield from (f"  | {line}".rstrip() for line in code.split("\n"))
        if solution.other_code:
            yield ""
            yield from self._wrapped(f"{OTHER}. {solution.other_way}", "  ")
            yield from (f"  | {line}".rstrip() for line in solution.other_code.split("\n"))

    def _heading(self, text: str) -> str:
        return self._styled(text, "1")

    def _styled(self, text: str, code: str) -> str:
        return f"\x1b[{code}m{text}\x1b[0m" if self._color else text

    def _wrapped(self, text: str, first: str = "", later: str | None = None) -> list[str]:
        return wrap(text, self._width, first, first if later is None else later)
