"""Tells when a mission in real time goes as it went in simulated time, so that its end is known."""

from __future__ import annotations

import math
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

from autograder.kit.mission.driving import movement
from autograder.kit.mission.track import NOTED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Part
    from autograder.kit.mission.moment import Moment

CHANGES, OVER = 2, 4.0
"""The number of changes of the commands that must be the same, and the seconds that they must span at least.

A node that does not go by ROS's clock changes its commands at other moments in simulated time. A single change
may be a matter of a counter, and several at once may be a matter of its start.
"""
AT_THE_SAME_TIME = 0.75
"""Seconds between two changes that count as the same: a command may be late, and the laser sees twice a second."""
STOOD = 2.5
"""Seconds for which a robot stands at the place at which the first look ended, after the same commands."""
NEAR = 0.3
"""The distance in meters between two places that count as the same."""


class _Change(NamedTuple):
    """A change of the commands: what they say from then on, and the seconds and the number of commands before."""

    movement: str
    seconds: float
    commands: int


class FirstLook:
    """What a mission was like in the first look.

    Args:
        part: The record of the first look.
        topic: The name of the topic with commands.
    """

    def __init__(self, part: Part, topic: str) -> None:
        self._changes = _changes(part.of("message", topic))
        noted = part.first("noted", NOTED)
        self._ways: Sequence[Any] = noted.data["ways"] if noted is not None else ()

    def is_confirmed(self, now: Moment) -> bool:
        """Return True if the present look has gone on as the first one, and will go on so."""
        if now.leg >= len(self._ways):
            return False
        mine, theirs = _changes(now.part.of("message", now.topic)), self._changes
        if len(mine) > len(theirs) or not all(map(_are_alike, mine, theirs)):
            return False
        changes = len(mine) - 1
        changed = changes >= CHANGES and mine[-1].seconds >= OVER
        way = self._ways[now.leg]
        hits_the_same_wall = now.bumped and any(now.to(tuple(bump)) < NEAR for bump in way["bumps"])
        is_last = len(mine) == len(theirs) and now.leg == len(self._ways) - 1
        stays = is_last and now.stood > STOOD and math.dist(now.pose.point, way["points"][-1]) < NEAR
        return changed or hits_the_same_wall or (changes > 0 and stays)


def _changes(commands: Sequence[Event]) -> list[_Change]:
    """Return each movement that is commanded, with the seconds and the number of commands before its first one."""
    firsts = [next(same) for _, same in groupby(enumerate(commands), lambda one: movement(one[1]))]
    return [_Change(movement(one), one.moment - commands[0].moment, number) for number, one in firsts]


def _are_alike(one: _Change, other: _Change) -> bool:
    # On a busy machine a timer is late, and counts on.
    at_once = abs(one.seconds - other.seconds) < AT_THE_SAME_TIME or one.commands == other.commands
    return one.movement == other.movement and at_once
