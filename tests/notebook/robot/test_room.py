"""What the laser sees in the two rooms."""

from __future__ import annotations

import math

import pytest

from autograder.notebook.robot.room import ROOM


@pytest.mark.parametrize(
    ("angle", "metres"),
    [
        (0.0, 5.0),
        (math.pi / 2, 2.0),
        (math.pi, 1.0),
        (-math.pi / 2, 2.0),
        (math.atan2(1.0, 3.0), math.hypot(3.0, 1.0)),
    ],
)
def test_a_ray_ends_at_the_first_wall_and_goes_through_the_door(angle: float, metres: float) -> None:
    assert ROOM.ranges((1.0, 2.0), (angle,)) == [pytest.approx(metres)]


def test_every_ray_of_every_place_ends() -> None:
    angles = tuple(math.tau * number / 97 for number in range(97))
    for x in (0.3, 2.0, 3.9, 4.1, 5.7):
        for y in (0.3, 2.0, 3.7):
            assert max(ROOM.ranges((x, y), angles)) < math.hypot(ROOM.width, ROOM.height)
