"""Lab 2.5, a model that is late: a reply counts for the newest question, and for two seconds."""

from math import inf
from random import Random

from lab_2_5._model import kind, order, reply, told

from autograder.kit import Text, ToolUser, Work, shuffled

PAUSE = 0.75
"""Seconds of the subject's time after each input."""


def steps(random: Random) -> list[Text | float]:
    """Return rows in drawn order. In each, a reply is in time, too late, replaced, or never comes."""

    def asks(*replies: str, takes: float, stands: float = 0.0) -> Text:
        return Text("/order", order(random, kind(*replies, takes=takes)), stands=stands)

    # Each moment is a quarter of a second or more away from the two seconds, and from the end of its step.
    rows: list[list[Text | float]] = [
        [asks("good", takes=0.2)],
        # Meanwhile the robot's time stands still for longer than two seconds: they are seconds of the robot's clock.
        [asks("good", takes=1.5, stands=2.2), 1.25],
        [asks("good", takes=2.8), 1.75, PAUSE],
        [asks(random.choice(("good", "nan")), takes=inf), 1.75, PAUSE],
        # Two tries of which each is in time, though both together are not.
        [asks(random.choice(("nan", "far", "chat")), "good", takes=1.25), 1.1, 1.25],
        [asks(*random.sample(("nan", "far", "chat", "text"), 3), takes=0.05)],
        # A newer order: the reply to the older one comes last, or first.
        [asks("good", takes=1.8), asks("good", takes=0.3), PAUSE, PAUSE],
        [asks("nan", "good", takes=1.1), asks("good", takes=1.1), PAUSE, PAUSE],
    ]
    return [step for row in shuffled(random, rows) for step in row]


EXERCISE = ToolUser(
    "lab_2_5.late",
    "Lab 2.5 · A model that is late",
    "Take a reply only for the newest question, and give it up after two seconds.",
    gives=steps,
    tells={"/said": "data"},
    asks={"/model": {"context": told}, "/lamp": "data"},
    does={"/walk_to": ("x", "y")},
    serves={
        "/model": lambda _: reply,
        "/lamp": lambda _: [{"success": True}],
        "/walk_to": lambda _: [Work()],
    },
    every=True,
    pause=PAUSE,
    roles=("publisher", "subscription", "client", "action_client"),
).exercise(
    text={
        "A reply counts only if its future is `self.open`": "lamp walk_to said",
        "gives up a question that has been open for more than 2 seconds": "said model",
        "goes on as before": "model",
    }
)
