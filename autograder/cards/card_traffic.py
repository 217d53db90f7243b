"""Chooses the moments of a check that a card shows, and groups them by part.

A judge may have seen hundreds of messages, but a card shows only a few dozen. Every part of the check gets an equal
share, and the card says how many moments are left out.
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
"""The lane that combines the lanes with the fewest moments, if a part has more than `MAX_LANES` lanes."""

OWN_LANE = "your code"
"""The lane for events of the program itself, such as its end."""

MAX_LANES = 8
_MAX_PARTS = 12
_LAST = {OTHER_LANES: 1, "log": 2, "printed": 3, OWN_LANE: 4}
_TOGETHER = 3
"""The maximum number of moments of a lane at one simulated time, for which the axis still shows times. If there are
more, one step of the simulated clock cannot have caused them all, and the axis numbers the moments instead.
"""


@dataclass(frozen=True)
class TrafficPart:
    """One part of the check, shown on one time axis.

    Attributes:
        title: The name of the part; empty if the check has only one part.
        simulated: True if the times are in simulated seconds.
        moments: The moments, sorted by time.
        gaps: The number of moments that were left out after a shown moment, by the index of the shown moment.
    """

    title: str
    simulated: bool
    moments: tuple[Moment, ...]
    gaps: Mapping[int, int] = field(default_factory=dict)

    @property
    def left_out(self) -> int:
        """The number of moments that the picture does not show, because the part has too many."""
        return sum(self.gaps.values())

    @property
    def lanes(self) -> tuple[str, ...]:
        """The lanes: first names on the ROS graph, in the order of their first moments; then the log and the output."""
        found = dict.fromkeys(moment.lane for moment in self.moments)
        return tuple(sorted(found, key=lambda lane: _LAST.get(lane, 0)))

    @property
    def kind_of_time(self) -> str:
        """The kind of time on the axis, in words."""
        return "simulated time" if self.simulated else "time"

    @functools.cached_property
    def stands_still(self) -> bool:
        """True if too many moments have the same time, so that the axis has to show their order instead of times."""
        if len({moment.t for moment in self.moments}) == 1:
            return True
        together = Counter((one.lane, one.t) for one in self.moments if one.direction != "expected")
        return self.simulated and max(together.values(), default=0) > _TOGETHER

    def when(self, index: int) -> str:
        """Return a moment's time, such as ``"0.500 s"``; if the clock :attr:`stands_still`, its number, ``"no. 3"``."""
        if self.stands_still and len(self.moments) > 1:
            return f"no. {index + 1}"
        return f"{self.moments[index].t:.3f} s"

    @property
    def is_worth_a_picture(self) -> bool:
        """True if there was any traffic on the graph or in the log. The end of a program alone needs no picture."""
        return any(moment.lane != OWN_LANE for moment in self.moments)


@dataclass(frozen=True)
class Traffic:
    """The traffic that a card shows.

    Attributes:
        parts: The parts that are shown, in order.
        parts_left_out: The number of parts that are not shown.
    """

    parts: tuple[TrafficPart, ...]
    parts_left_out: int = 0

    @property
    def left_out(self) -> int:
        """The number of moments that are left out of the shown parts."""
        return sum(part.left_out for part in self.parts)

    @property
    def simulated(self) -> bool:
        """True if any of the times is simulated."""
        return any(part.simulated for part in self.parts)


def traffic(timeline: Sequence[Moment], *, at_most: int) -> Traffic:
    """Group a timeline by part, and keep about ``at_most`` of its moments."""
    groups: dict[tuple[str, bool], list[Moment]] = {}
    for moment in timeline:
        # One axis shows one kind of time, so a part that has both kinds is split.
        groups.setdefault((moment.part, moment.simulated), []).append(
            moment if math.isfinite(moment.t) else replace(moment, t=0.0)
        )
    shown = list(groups.items())[:_MAX_PARTS]
    total = sum(len(moments) for _, moments in shown)
    parts = []
    for (title, simulated), moments in shown:
        share = len(moments) if total <= at_most else max(4, at_most * len(moments) // total)
        parts.append(_part(title, simulated, moments, share))
    return Traffic(tuple(parts), len(groups) - len(shown))


def _part(title: str, simulated: bool, moments: list[Moment], share: int) -> TrafficPart:
    ordered = _few_lanes(sorted(moments, key=lambda moment: moment.t))
    if len(ordered) <= share + 2:  # one or two moments are not worth a mark that says that some are left out
        return TrafficPart(title, simulated, tuple(ordered))
    # Keep both ends: the beginning shows the pattern and the end shows the outcome. The middle only repeats the
    # pattern, so it is left out, except for important moments.
    tail = share // 3
    head = share - tail
    kept: list[Moment] = []
    gaps: dict[int, int] = {}
    for index, moment in enumerate(ordered):
        if index < head or index >= len(ordered) - tail or moment.key:
            kept.append(moment)
        else:
            gaps[len(kept) - 1] = gaps.get(len(kept) - 1, 0) + 1
    return TrafficPart(title, simulated, tuple(kept), gaps)


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
