"""Exercise 1.3, a wall on the way: a client cancels its walk when the laser sees a wall, once."""

from typing import Any

from autograder.kit import Mission, Moment, Pose, Wall, World
from autograder.kit.mission.mission import ROOM, Walls
from autograder.robot.sensors import laser_scan, look_around

NEAR, MOST = 1.5, 2
"""Below how many meters a wall is near, and how many near scans may come until the request is there."""


def blocked(x: float) -> World:
    """Return the two rooms with one wall more, right across the way of the robot."""
    return World(Walls([*ROOM.walls, Wall((x, 0), (x, 4))]), Pose(1.0, 2.0, 0.0))


def through_the_wall(now: Moment) -> dict[str, Any] | None:
    """Return one scan, as soon as the client has asked to cancel, in which the way is free; None for what is there.

    A client that forgets then that it has asked, asks again at the next scan.
    """
    asked = now.part.events[len(now.before("cancel").part.events) :] if now.part.of("cancel") else []
    if not asked or any(event.kind == "sent" for event in asked):
        return None
    return laser_scan(look_around(now.pose, ROOM), round(now.time * 1e9))


def ahead_until_cancel(now: Moment) -> list[float]:
    """Return how far the robot saw ahead, in meters, in each scan before its client first asked to cancel."""
    return [event.data["fields"]["ranges"][0] for event in now.before("cancel").part.of("sent", "/scan")]


def too_early(now: Moment) -> str:
    """Return in meters what the last scan said if the client asked to cancel before any was near; else nothing."""
    seen = ahead_until_cancel(now) if now.part.of("cancel") else []
    return f"{seen[-1]:.3g}" if seen and min(seen) >= NEAR else ""


def too_late(now: Moment) -> int:
    """Return how many near scans came before the client asked to cancel, if more than chance explains; else 0."""
    near = sum(ahead < NEAR for ahead in ahead_until_cancel(now))
    return near if near > MOST else 0


EXERCISE = Mission(
    "exercise_1_3.wall",
    "Exercise 1.3 · A wall on the way",
    "Send the robot to a point, and cancel the walk once when the laser sees a wall near ahead.",
    roles=("action_client", "subscription"),
    # Where the wall is depends on what the laser sees twice a second, each time a quarter of a meter further on: so a
    # limit of any size is right or wrong in all of these worlds.
    draws=lambda random: [blocked(random.choice((3.5, 3.75, 4.25, 4.5)))],
    senses={"/scan": through_the_wall},
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
        (
            "cancel_missing",
            lambda now: now.part.of("goal") and not now.part.of("cancel") and not now.part.traceback,
            "Your node sent the goal, and never asked to cancel it.",
            "In on_scan, call cancel_goal_async() of the goal handle, with its parentheses, when ranges[0] is small.",
        ),
        (
            "cancel_too_early",
            too_early,
            "Your node asked to cancel when the wall ahead was still {} m away.",
            "ranges[0] is straight ahead, and the other numbers are not: cancel if it is less than 1.5.",
        ),
        (
            "cancel_too_late",
            too_late,
            "{} scans said that the wall ahead was nearer than 1.5 m before your node asked to cancel.",
            "Ask at the first of them: compare ranges[0] with 1.5.",
        ),
    ],
).exercise(
    text={
        "sends the goal x = 5.5, y = 2.0 to the action `walk_to`, once": "goal",
        "At the first scan whose `ranges[0]` is less than 1.5 meters, ask to cancel the goal.": "stands touches",
        "Ask only once.": "cancel",
    },
)
