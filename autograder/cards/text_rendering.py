"""Shows a verdict as plain text: in terminals, in logs and for screen readers.

The text has the same words as the HTML card, in the same order. Its marks are ASCII only, so that any terminal can
show them. It has no columns, because a screen reader would read them in the wrong order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Unpack

from autograder.cards import card_wording, readable_text
from autograder.cards.card_content import IN_A_TERMINAL, Card, Choices, CriterionRow, Solution, marked
from autograder.cards.readable_text import one_line, wrap
from autograder.cards.readable_text import width as columns
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from autograder.cards.card_traffic import TrafficPart
    from autograder.verdict import Verdict


_MARK = IN_A_TERMINAL.mark
_ARROWS = {"from_subject": "-->", "to_subject": "<--", "expected": "..>"}
_COLORS = {State.PASSED: "32", State.FAILED: "33", State.NOT_CHECKED: "34", State.CHECKING: "34"}
_NARROWEST = 40


def card_text(
    verdict: Verdict,
    *,
    width: int = 88,
    color: bool = False,
    **choices: Unpack[Choices],
) -> str:
    """Return a verdict as text for a terminal.

    Args:
        width: The maximum length of a line in columns, at least 40. Lines of a traceback may be longer.
        color: True to add ANSI codes (bold, and a color for the state). The text says the same without them.

    Returns:
        The lines as one text, without a newline at the end.
    """
    card = Card.of(verdict, IN_A_TERMINAL, **choices)
    return "\n".join(_Writer(max(width, _NARROWEST), color).card(card))


@dataclass(frozen=True)
class _Writer:
    width: int
    color: bool

    def card(self, card: Card) -> Iterator[str]:
        yield from self._head(card)
        yield from self._advice(card)
        if card.criteria:
            yield ""
            yield self._heading(card_wording.ASKED if card.nothing_seen else "Criteria")
            for row in card.criteria:
                yield from self._asked(row) if card.nothing_seen else self._criterion(row)
            if card.counts and card.state is not State.PASSED:
                yield from self._wrapped(card.counts, "  ")
        if card.remarks:
            yield ""
            yield self._heading("Worth mentioning (costs no points)")
            for remark in card.remarks:
                yield from self._wrapped(remark, "  - ", "    ")
        if card.ways:
            yield ""
            yield self._heading(card_wording.WAY)
            for way in card.ways:
                yield from self._wrapped(way.sentence, "  ", "  ")
        if card.traffic.parts:
            yield from self._traffic(card)
        if card.detail:
            yield ""
            yield from self._wrapped(card.detail_heading)
            yield from _listing(card.detail)
        if card.solution:
            yield from self._solution(card.solution)
        if card.facts:
            yield ""
            yield from self._wrapped(f"({one_line(', '.join(card.facts), 200, mark=_MARK)})", "", " ")

    def _head(self, card: Card) -> Iterator[str]:
        yield from (self._styled(line, "1") for line in self._wrapped(card.title))
        state = card.state_words.upper()
        how = f"{state}: {card.score_line}" + (f", {card.tally}" if card.tally else "")
        first, *rest = self._wrapped(how, "", "  ")
        yield self._styled(state, f"1;{_COLORS[card.state]}") + first.removeprefix(state)
        yield from rest
        yield "-" * min(self.width, max(columns(how), columns(card.title)))
        if card.notice:
            yield from self._wrapped(card.notice)

    def _advice(self, card: Card) -> Iterator[str]:
        advice = card.advice
        if advice.heading:
            yield self._heading(advice.heading)
        yield from self._wrapped(advice.text, "  " if advice.heading else "")
        if card.place:
            yield from self._wrapped(f"{card.place.where}: {card.place.quote}".rstrip(": "), "  ", "    ")
        if advice.next_step:
            yield ""
            yield self._heading("What to do next")
            yield from self._wrapped(advice.next_step, "  > ", "    ")

    def _asked(self, row: CriterionRow) -> Iterator[str]:
        yield from self._wrapped(f"{row.title} ({row.possible})", "  - ", "    ")
        yield from self._wrapped(row.counts, "    ") if row.counts else ()

    def _criterion(self, row: CriterionRow) -> Iterator[str]:
        badge = self._styled(f"[{row.word}]", _COLORS[row.state])
        line = f"{row.title} ({row.points} {row.unit})"
        first, *rest = self._wrapped(line, " " * (len(row.word) + 5), "    ")
        yield f"  {badge} {first.lstrip()}"
        yield from rest
        if row.state is State.CHECKING:
            return
        named = {} if row.passed else {"expected": row.expected}
        named["seen"] = row.seen
        if row.difference:
            named[card_wording.DIFFERENCE] = one_line(marked(row.difference), 240, mark=_MARK)
        if row.counts and not row.passed:
            named[card_wording.COUNTS] = row.counts
        for name, value in named.items():
            yield from self._wrapped(value, f"    {name}: ", "      ")

    def _traffic(self, card: Card) -> Iterator[str]:
        yield ""
        parts = card.traffic.parts
        missed = any(moment.direction == "expected" for part in parts for moment in part.moments)
        ghost = f"..> {card_wording.DIRECTION_WORDS['expected']}, " if missed else ""
        heading = f"What was on the wire (--> from your code, <-- to your code, {ghost}* note)"
        yield from (self._heading(line) for line in self._wrapped(heading))
        for part in parts:
            yield from self._part(part)
        if card.traffic_notes:
            yield from self._wrapped(card.traffic_notes, "  ")

    def _part(self, part: TrafficPart) -> Iterator[str]:
        if part.title:
            yield from self._wrapped(one_line(part.title, 120, mark=_MARK) + ":", "  ", "  ")
        lanes = {lane: one_line(lane, self.width * 3 // 8, mark=_MARK) for lane in part.lanes}
        lane_columns = max(map(columns, lanes.values()))
        for index, moment in enumerate(part.moments):
            arrow = _ARROWS.get(moment.direction, " * ")
            lane = lanes[moment.lane]
            padding = " " * (lane_columns - columns(lane))
            start = f"  {part.when(index):>11}  {lane}{padding} {arrow} "
            label = readable_text.label(moment.label, self.width - columns(start), mark=_MARK)
            yield from (line.rstrip() for line in self._wrapped(label, start, " " * columns(start)))
            if index in part.gaps:
                yield f"            {_MARK} {part.gaps[index]} more left out here"

    def _solution(self, solution: Solution) -> Iterator[str]:
        for whose, lines in solution.changes.items():
            yield ""
            yield self._heading(whose)
            yield from _listing(lines)
        if solution.changes:
            return
        yield ""
        yield self._heading(card_wording.SOLUTION)
        yield from self._wrapped(solution.why, "  ")
        for code in solution.code:
            yield ""
            yield from _listing(code.split("\n"))
        if solution.other_code:
            yield ""
            yield from self._wrapped(f"{card_wording.OTHER_WAY}. {solution.other_way}", "  ")
            yield from _listing(solution.other_code.split("\n"))

    def _heading(self, text: str) -> str:
        return self._styled(text, "1")

    def _styled(self, text: str, code: str) -> str:
        return f"\x1b[{code}m{text}\x1b[0m" if self.color else text

    def _wrapped(self, text: str, first: str = "", later: str | None = None) -> list[str]:
        return wrap(text, self.width, first, first if later is None else later)


def _listing(lines: Iterable[str]) -> Iterator[str]:
    """Yield lines of code or output, indented but otherwise unchanged."""
    return (f"  | {line}".rstrip() for line in lines)
