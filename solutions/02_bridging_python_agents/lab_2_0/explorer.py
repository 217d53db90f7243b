"""Lab 2.0, both brains together: a robot that turns away in front of walls."""

from autograder.kit import Mission, Moment, Pose, World

LEFT, RIGHT = (f"Turns to the {side} where there is more room" for side in ("left", "right"))
ENOUGH = 45.0
"""Seconds for each of the two turns: a robot of a fifth of the speed needs less, wherever it starts."""


def turned(now: Moment) -> float:
    """Return by how many radians the robot has turned to the left; 0.0 once it has turned too far to say."""
    return now.pose.heading if abs(now.pose.heading) < 2.4 else 0.0


def turns(now: Moment) -> list[float]:
    """Return the turns of the robot's commands in order, in radians per second, without 0.0 for a straight way."""
    return [turn for event in now.part.of("message") if (turn := event.data["fields"]["angular"]["z"])]


def first_turn(now: Moment) -> float:
    """Return the first turn of the robot's commands, in radians per second; 0.0 if none of them turns."""
    return next(iter(turns(now)), 0.0)


def turns_left(now: Moment) -> bool:
    """Return True in the first world if the robot's first turn there is to the left, and not a way round."""
    return now.leg == 0 and first_turn(now) > 0


def turns_to_the_other_side(now: Moment) -> bool:
    """Return True if the robot first turns to the right, where there is less room, and at another wall to the left.

    What it reaches in the second world is a matter of luck, since it has been lost for long; a robot that always turns
    to the right reaches its line there by right.
    """
    return first_turn(now) < 0 and max(turns(now)) > 0


def is_done_on_the_left(now: Moment) -> bool:
    """Return True if the robot has turned to the left, or had far more time for it than a slow one needs."""
    return LEFT in now.reached or now.time > ENOUGH


EXERCISE = Mission(
    "lab_2_0.explorer",
    "Lab 2.0 · The exploring robot",
    "Let your agent drive the robot: ahead, and away from walls.",
    roles=("publisher", "subscription"),
    draws=lambda random: [
        World(start=Pose(random.uniform(1.5, 2.5), random.uniform(0.8, 1.2), 0.0)),
        is_done_on_the_left,
        World(start=Pose(random.uniform(1.5, 2.5), random.uniform(2.8, 3.2), 0.0)),
    ],
    reaches=[
        (
            LEFT,
            lambda now: turns_left(now) and now.pose.x > 3 and turned(now) > 0.7 and now.velocity.turn > 0,
            "left",
        ),
        (
            RIGHT,
            lambda now: now.leg == 1 and now.pose.x > 3 and turned(now) < -0.7 and now.velocity.turn < 0,
            "right",
        ),
        (
            "Drives on after the turn",
            lambda now: RIGHT in now.reached and turned(now) < -0.7 and now.velocity.forward,
            "on",
        ),
    ],
    never=[("Touches no wall", lambda now: now.bumped, "walls")],
    knows=[
        (
            "other_side",
            turns_to_the_other_side,
            "Your robot turns to the side with less room.",
            "To the left is a positive turn. Compare seen.left with seen.right, and hand command.turn on as angular.z.",
        ),
    ],
    within=2 * ENOUGH,
).exercise(
    text={
        "The class attribute `agent_class` says which agent a bridge makes": "left right on walls",
    }
)
