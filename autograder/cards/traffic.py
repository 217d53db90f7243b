"""Which moments of a check a card shows, and in which groups.

A judge may have seen hundreds of messages; a card shows a few dozen. Every part of the check keeps a fair
share, and what was left out is counted, never hidden.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.verdict import Moment

OTHER_LANES = "other names"
"""The lane that collects what happened beyond the first `MAX_LANES` names of a part."""

MAX_LANES = 8
_MAX_PARTS = 12


@dataclass(frozen=True)
class Part:
    """One part of the check on one time axis.

    Attributes:
        title: The part's name; empty where the check has one part only.
        simulated: Whether the times are simulated seconds.
        moments: In order of time.
        left_out: How many moments are not among ``moments``.
        after: Index of the moment after which the left-out ones belong.
    """

    title: str
    simulated: bool
    moments: tuple[Moment, ...]
    left_out: int = 0
    after: int = 0

    @property
    def lanes(self) -> tuple[str, ...]:
        """The lanes, in order of their first moment."""
        return tuple(dict.fromkeys(moment.lane for moment in self.moments))


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
        """Whether any of the times is simulated."""
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
    # The beginning shows the pattern and the end how it went out; the middle repeats.
    tail = share // 3
    head = share - tail
    kept = [*ordered[:head], *ordered[-tail:]]
    return Part(title, simulated, tuple(kept), left_out=len(ordered) - len(kept), after=head - 1)


def _few_lanes(moments: list[Moment]) -> list[Moment]:
    lanes = list(dict.fromkeys(moment.lane for moment in moments))
    if len(lanes) <= MAX_LANES:
        return moments
    own = set(lanes[: MAX_LANES - 1])
    return [
        moment
        if moment.lane in own
        else replace(moment, lane=OTHER_LANES, label=f"{moment.lane}: {moment.label}")
        for moment in moments
    ]


def _with_finite_time(moment: Moment) -> Moment:
    return moment if math.isfinite(moment.t) else replace(moment, t=0.0)
