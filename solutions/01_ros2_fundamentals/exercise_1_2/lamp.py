"""Exercise 1.2, a robot's lamp: a client in a callback calls once for each change, and does not wait there."""

from autograder.kit.mission.mission import Mission, Moment, Pose, World
from autograder.kit.rules import value

PLACES = ((2.8, 2.9), (3.1, 3.2), (5.1, 5.2), (4.8, 4.9), (2.8, 2.9), (3.1, 3.2))
"""The places of the robot, one after the other: x in meters, on both sides of the door, each near the limit.

In a wider range, chance would decide whether a wrong limit shows.
"""
CHANGES = 5
"""How often the lamp has to change there: on and off by turns."""


def calls(now: Moment) -> str:
    """Return in words what was asked of the lamp, in order."""
    switched = ["on" if value(event) else "off" for event in now.part.of("request", "/lamp")]
    return ", ".join(switched) or "no call"


EXERCISE = Mission(
    "exercise_1_2.lamp",
    "Exercise 1.2 · The lamp at the door",
    "Switch the robot's lamp on when it comes near the door, and off when it leaves.",
    roles=("client", "subscription"),
    draws=lambda random: [
        step for place in PLACES for step in (World(start=Pose(random.uniform(*place), 2.0, 0.0)), 0.6)
    ],
    same=[("Calls once for each change, in time", calls, "lamp", 10)],
    knows=[
        (
            "no_call",
            lambda now: not now.part.of("request") and not now.part.traceback,
            "Your node never called the service lamp, although the robot came near the door.",
            "Compare x with the door's place in on_odom, and call self.lamp.call_async(SetBool.Request(data=...)).",
        ),
        (
            "too_many_calls",
            lambda now: (count := len(now.part.of("request"))) > CHANGES and count,
            "Your node called the service lamp {} times, and the lamp had to change less often.",
            "Store in self.is_on what the lamp is now, and call only if it has to change.",
            {"certain": True},
        ),
    ],
    within=30.0,
).exercise(
    text={
        "Let the lamp be on while the robot is less than 1 meter from the door, at `x = 4`, and off elsewhere.": "lamp",
        "Call the service once for each change, and never more often.": "lamp",
    },
)
