"""The first notebook, at its end: a robot drives through the door, turns around, and comes back."""

from autograder.kit.mission.mission import Mission, Moment

THERE, BACK = "Drives into the right room", "Comes back into the left room"


def place(now: Moment) -> str:
    """Return where the robot was in the end."""
    return f"x = {now.pose.x:.1f} m, y = {now.pose.y:.1f} m"


EXERCISE = Mission(
    "00_nervous_system.back",
    "The robotic nervous system · There and back",
    "Drive through the door into the right room, turn around, and come back through the door.",
    reaches=[
        (THERE, lambda now: now.pose.x > 4.5, "there", 3),
        (BACK, lambda now: THERE in now.reached and now.pose.x < 3.5, "back", 3),
        ("Stands still there", lambda now: BACK in now.reached and now.stood > 2.0, "stands", 2),
    ],
    never=[("Touches no wall", lambda now: now.bumped, "touches", 2)],
    knows=[
        (
            "wrong_movement",
            lambda now: now.bumped and place(now),
            "A wall is in the way of your robot, at {}.",
            "Count what each part sends: sixteen commands ahead, four that turn, sixteen ahead, and then only zeros.",
        ),
        (
            "wrong_movement",
            lambda now: now.commands and BACK not in now.reached and place(now),
            "Your robot ends at {}, and has not been there and back.",
            "Compare what you set with the count: linear.x = 0.5 goes ahead, angular.z = 1.57 turns. Publish each one.",
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
