"""A mission: a robot drives ahead, and stops in front of a wall that its laser sees."""

from autograder.kit import Mission, Moment, Pose, World


def stopped(now: Moment) -> float:
    """Return the distance at which the robot has stopped too early; 0 if it has not."""
    return now.ahead if "Drives ahead" in now.reached and now.ahead > 1.2 else 0.0


EXERCISE = Mission(
    "mission.brake",
    "A mission · The brake",
    "Drive ahead, and stop in front of the wall.",
    roles=("publisher", "subscription"),
    draws=lambda random: [World(start=Pose(random.choice((0.5, 0.8, 1.25, 1.7)), 1.0, 0.0))],
    reaches=[
        ("Drives ahead", lambda now: abs(now.velocity.forward - 0.3) < 0.02, "drives", 2),
        ("Stands in front of the wall", lambda now: 0.45 < now.ahead < 0.9 and now.stood > 1.0, "stands", 5),
    ],
    never=[("Touches no wall", lambda now: now.bumped, "touches", 3)],
    knows=[
        ("never_stops", lambda now: now.bumped, "Your robot drives into the wall.", "Send 0 at 0.8 m."),
        ("stops_early", stopped, "Your robot stops {:.1f} m in front of the wall.", "Stop at 0.8 m."),
    ],
    within=60.0,
).exercise(text={"drive ahead with 0.3 m/s": "drives", "stop at 0.8 m": "stands touches"})
