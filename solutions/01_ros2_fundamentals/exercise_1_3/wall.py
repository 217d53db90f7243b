"""Exercise 1.3, a wall on the way: a client cancels its walk when the laser sees a wall, once."""

from autograder.kit import Mission, Pose, Wall, World
from autograder.kit.mission.mission import ROOM, Walls


def blocked(x: float) -> World:
    """Return the two rooms with one wall more, right across the way of the robot."""
    return World(Walls([*ROOM.walls, Wall((x, 0), (x, 4))]), Pose(1.0, 2.0, 0.0))


EXERCISE = Mission(
    "exercise_1_3.wall",
    "Exercise 1.3 · A wall on the way",
    "Send the robot to a point, and cancel the walk once when the laser sees a wall near ahead.",
    roles=("action_client", "subscription"),
    # Where the wall is depends on what the laser sees twice a second, each time a quarter of a meter further on: so a
    # limit of any size is right or wrong in all of these worlds.
    draws=lambda random: [blocked(random.choice((3.5, 3.75, 4.25, 4.5)))],
    # After a request to cancel, the robot brakes for half a meter: it ends 0.75 to 1 m away.
    reaches=[
        ("Stands in front of the wall", lambda now: 0.6 < now.ahead < 1.05 and now.stood > 2.0, "stands", 4)
    ],
    same=[
        ("Sends the robot to the point", lambda now: now.sent("/walk_to"), "goal", 2),
        ("Asks once to cancel", lambda now: len(now.part.of("cancel")), "cancel", 2),
    ],
    never=[("Touches no wall", lambda now: now.bumped, "touches", 2)],
    knows=[
        (
            "cancel_repeated",
            lambda now: (count := len(now.part.of("cancel"))) > 1 and count,
            "Your node asked {} times to cancel its walk: scans go on for a moment after the first request.",
            "Remember that you have asked: set the goal handle to None, and ask only if it is not None.",
        ),
    ],
).exercise(
    text={
        "sends the goal x = 5.5, y = 2.0 to the action `walk_to`, once": "goal",
        "At the first scan whose `ranges[0]` is less than 1.5 meters, ask to cancel the goal.": "stands touches",
        "Ask only once.": "cancel",
    },
)
