"""Inspecting actions, a chain of callbacks: a node walks to the door, and switches the lamp on once it is there."""

from autograder.kit.mission.mission import Mission, Pose, World

EXERCISE = Mission(
    "inspecting_actions.chain",
    "Inspecting actions · A chain of callbacks",
    "Walk to the door, and switch the lamp on when the walk has ended.",
    roles=("action_client", "client"),
    draws=lambda random: [World(start=Pose(random.uniform(0.8, 2.0), 2.0, 0.0))],
    reaches=[
        ("Walks to the door", lambda now: now.to((4.0, 2.0)) < 0.2, "there", 4),
        ("Switches the lamp on", lambda now: now.lamp, "lamp", 2),
    ],
    never=[
        ("Not before the result has arrived", lambda now: now.lamp and not now.part.of("result"), "after", 2)
    ],
    same=[("One goal and one call", lambda now: f"{now.sent('/walk_to')}; {now.asked('/lamp')}", "once", 2)],
).exercise(
    text={
        "Send the goal x = 4.0, y = 2.0, the door, to the action `walk_to`, once.": "there once",
        "When the result has arrived, call the service `lamp` once, with `data` true.": "lamp after once",
    },
    counts={"": "A program that waits for each answer outside of callbacks counts as well."},
)
