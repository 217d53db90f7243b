"""The exercise that judges the runaway: a remote control drives the robot, falls silent, and drives it again."""

from autograder.kit.mission.mission import Mission, Pose, To, World

SECONDS, SILENCE = 2.6, 3.5
"""How long the remote control speaks, and how long it is silent, in seconds."""


def held(speed: float) -> list[To | float]:
    """Return the steps of a remote control that speaks ten times a second, but not evenly: as a radio does."""
    command = To("/remote", {"linear": {"x": speed}})
    return [step for _ in range(round(5 * SECONDS)) for step in (command, command, 0.2)]


EXERCISE = Mission(
    "bugs_2._remote",
    "Bug hunt 2 · The driver",
    "Pass the commands on, and let the robot stand if none come.",
    roles=("publisher", "subscription"),
    draws=lambda random: [
        step
        for steps in (held(0.5), [SILENCE], held(0.4))
        for step in (World(start=Pose(random.uniform(0.8, 1.0), 2.0, 0.0)), *steps)
    ],
    reaches=[
        ("Drives while the tablet speaks", lambda now: now.leg == 0 and now.pose.x > 1.7),
        ("Stands while the tablet is silent", lambda now: now.leg == 1 and now.stood > 1.0),
        ("Drives again when the tablet speaks again", lambda now: now.leg == 2 and now.pose.x > 1.7),
    ],
).exercise()
