"""The moments of a check that a card shows, in groups.

A judge may have seen hundreds of messages; a card shows a few dozen. Every part of the check keeps a fair
share, and what was left out is counted, never hidden.
"""

from __future__ import annotations

import functools
import math
from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.verdict import Moment

OTHER_LANES = "other names"
"""The lane that collects what happened where least did, in a part with more than `MAX_LANES` lanes."""

OWN_LANE = "your code"
"""The lane of what the program itself did, such as to end."""

MAX_LANES = 8
_MAX_PARTS = 12
_LAST = {OTHER_LANES: 1, "log": 2, "printed": 3, OWN_LANE: 4}
_TOGETHER = 3
"""Moments of a lane at one simulated time beyond which the clock was not what made them happen."""


@dataclass(frozen=True)
class Part:
    """One part of the check on one axis.

    Attributes:
        title: The part's name; empty where the check has one part only.
        simulated: Whether the times are simulated seconds.
        moments: In order of time.
        gaps: Index of a moment -> how many are left out behind it.
    """

    title: str
    simulated: bool
    moments: tuple[Moment, ...]
    gaps: Mapping[int, int] = field(default_factory=dict)

    @property
    def left_out(self) -> int:
        """The number of moments that are not among ``moments``."""
        return sum(self.gaps.values())

    @property
    def lanes(self) -> tuple[str, ...]:
        """The lanes: names on the graph in order of their first moment, then what was said of it."""
        found = dict.fromkeys(moment.lane for moment in self.moments)
        return tuple(sorted(found, key=lambda lane: _LAST.get(lane, 0)))

    @property
    def kind_of_time(self) -> str:
        """The name of what its axis shows."""
        return "simulated time" if self.simulated else "time"

    @functools.cached_property
    def stands_still(self) -> bool:
        """True if time says nothing about the order: all at once or, by a clock that was moved, nearly so."""
        if len({moment.t for moment in self.moments}) == 1:
            return True
        together = Counter((one.lane, one.t) for one in self.moments if one.direction != "expected")
        return self.simulated and max(together.values(), default=0) > _TOGETHER

    def when(self, index: int) -> str:
        """The time of a moment: ``"0.500 s"``; its turn, such as ``"no. 3"``, where time stood still."""
        if self.stands_still and len(self.moments) > 1:
            return f"no. {index + 1}"
        return f"{self.moments[index].t:.3f} s"

    @property
    def is_worth_a_picture(self) -> bool:
        """True if anything was on the graph or in the log: that a program ended is told elsewhere."""
        return any(moment.lane != OWN_LANE for moment in self.moments)


@dataclass(frozen=True)
class Traffic:
    """All that a card shows of the traffic.

    Attributes:
        parts: In order of appearance.
        parts_left_out: Parts beyond those, of which nothing is shown.
    """

    parts: tuple[Part, ...]
    parts_left_out: int = 0

    @property
    def left_out(self) -> int:
        """Moments that are not shown in the parts that are."""
        return sum(part.left_out for part in self.parts)

    @property
    def simulated(self) -> bool:
        """True if any of the times is simulated."""
        return any(part.simulated for part in self.parts)


def traffic(timeline: Sequence[Moment], *, at_most: int) -> Traffic:
    """Group a timeline by part and keep about ``at_most`` of its moments."""
    groups: dict[tuple[str, bool], list[Moment]] = {}
    for moment in timeline:
        # One axis has one kind of time: a part that mixes both becomes two.
        groups.setdefault((moment.part, moment.simulated), []).append(_with_finite_time(moment))
    shown = list(groups.items())[:_MAX_PARTS]
    total = sum(len(moments) for _, moments in shown)
    parts = []
    for (title, simulated), moments in shown:
        share = len(moments) if total <= at_most else max(4, at_most * len(moments) // total)
        parts.append(_part(title, simulated, moments, share))
    return Traffic(tuple(parts), len(groups) - len(shown))


def _part(title: str, simulated: bool, moments: list[Moment], share: int) -> Part:
    ordered = _few_lanes(sorted(moments, key=lambda moment: moment.t))
    if len(ordered) <= share + 2:  # to leave out one or two saves nothing
        return Part(title, simulated, tuple(ordered))
    # The beginning shows the pattern and the end how it went out; the middle repeats, but for what the story is about.
    tail = share // 3
    head = share - tail
    kept: list[Moment] = []
    gaps: dict[int, int] = {}
    for index, moment in enumerate(ordered):
        if index < head or index >= len(ordered) - tail or moment.key:
            kept.append(moment)
        else:
            gaps[len(kept) - 1] = gaps.get(len(kept) - 1, 0) + 1
    return Part(title, simulated, tuple(kept), gaps)


def _few_lanes(moments: list[Moment]) -> list[Moment]:
    counts = Counter(moment.lane for moment in moments)
    if len(counts) <= MAX_LANES:
        return moments
    own = {lane for lane, _ in counts.most_common(MAX_LANES - 1)}
    return [
        moment
        if moment.lane in own
        else replace(moment, lane=OTHER_LANES, label=f"{moment.lane}: {moment.label}", key=False)
        for moment in moments
    ]


def _with_finite_time(moment: Moment) -> Moment:
    return moment if math.isfinite(moment.t) else replace(moment, t=0.0)
