"""The first notebook, at its end: a robot drives through the door, turns around, and comes back."""

from itertools import groupby
from math import cos

from autograder.kit import Mission, Moment
from autograder.kit.mission.driving import movement
from autograder.kit.mission.moment import number_of

COUNT = (
    "Compare with the task: 16 × linear.x = 0.5, then 4 × angular.z = 1.57, then 16 × linear.x = 0.5, then all numbers "
    "0. self.count is 0 for the first command, so the first sixteen have the counts 0 to 15."
)
THERE, BACK = "Drives into the right room", "Comes back into the left room"
FASTEST_TURN = 2.0
"""The most radians per second that the robot turns."""
PARTS = 4
"""The most parts of a way that a card names."""


def way(now: Moment) -> str:
    """Return in words what the robot was told, one part of its way after the other, and where it was in the end."""
    parts = [(said, len(list(same))) for said, same in groupby(now.part.of("message", now.topic), movement)]
    told = ", then ".join(f"{count} × {said}" for said, count in parts[:PARTS])
    more = ", and more" if parts[PARTS:] else ""
    return f"{told}{more}. It ended at x = {now.pose.x:.1f} m, y = {now.pose.y:.1f} m"


def too_fast(now: Moment) -> str:
    """Return the fastest turn that was commanded, in radians per second; empty if the robot turns so fast."""
    turns = (abs(number_of(command, "angular", "z")) for command in now.part.of("message", now.topic))
    fastest = max(turns, default=0.0)
    return f"{fastest:g}" if fastest > FASTEST_TURN and BACK not in now.reached else ""


def faces_left(now: Moment) -> bool:
    """Return True if the robot has turned around, so that it does not come back in reverse."""
    return cos(now.pose.heading) < 0


EXERCISE = Mission(
    "00_nervous_system.back",
    "The robotic nervous system · There and back",
    "Drive through the door into the right room, turn around, and come back through the door.",
    reaches=[
        (THERE, lambda now: now.pose.x > 4.5, "there", 3),
        (BACK, lambda now: THERE in now.reached and now.pose.x < 3.5 and faces_left(now), "back", 3),
        ("Stands still there", lambda now: BACK in now.reached and now.stood > 2.0, "stands", 2),
    ],
    never=[("Touches no wall", lambda now: now.bumped, "touches", 2)],
    knows=[
        (
            "too_fast",
            too_fast,
            "Your robot is told to turn with {} radians per second, and it turns by at most 2 in a second.",
            "angular.z is in radians per second, and half a turn is 3.14 radians. Turn more slowly, with more "
            "commands.",
        ),
        (
            "wrong_movement",
            lambda now: now.bumped and way(now),
            "Your robot drives against a wall. Its commands were {}.",
            COUNT,
        ),
        (
            "wrong_movement",
            lambda now: THERE in now.reached and now.pose.x < 3.5 and not faces_left(now) and way(now),
            "Your robot comes back in reverse: it does not turn around. Its commands were {}.",
            COUNT,
        ),
        (
            "wrong_movement",
            lambda now: now.commands and BACK not in now.reached and way(now),
            "Your robot has not been there and back. Its commands were {}.",
            COUNT,
        ),
    ],
    within=60.0,
).exercise(
    text={
        "let the robot drive through the door into the right room": "there",
        "come back through the door": "back",
        "without touching a wall": "touches",
        "After the last command ahead, let it stand.": "stands",
    },
    counts={"": "How you count, and how fast your robot drives and turns, is not graded."},
)
