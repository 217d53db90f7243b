"""Lab 2.6, a door that a person confirms: no, nothing, a late yes, and a newer order leave it closed."""

from itertools import pairwise
from random import Random

from lab_2_6._model import answer, order, reply, room, told, walk

from autograder.kit import Text, ToolUser, Work, drawn_until, shuffled

PAUSE = 1.25
"""Seconds of the subject's time after each input."""
OPENS = 1.25
"""Seconds until a door is open."""


def steps(random: Random) -> list[Text | float]:
    """Return rows in drawn order. In each a person says yes or no, or nothing, or a newer order comes first."""
    no, late, never = "no", "late", "never"
    # What a person says comes a quarter of a second or more away from the two seconds, and from the end of a step.
    # So does the answer of the door: a node that reports at once, reports in the step before.
    rows: list[list[Text | float]] = [
        [order(random, "yes", "done"), PAUSE],
        [order(random, "lamp", "slowly", "done"), 2.25],
        [order(random, no, "lamp", "done"), PAUSE],
        [order(random, "perhaps", "done"), PAUSE],
        [order(random, "shouts", "done"), PAUSE],
        [order(random, never, random.choice(("lamp", "walk")), "done"), 1.75, PAUSE],
        # A question that is open for two seconds and a half is given up in the next step only.
        [order(random, late, "done"), 1.15, 1.4, PAUSE],
        # The budget ends with a door that nobody has confirmed, and then the person says yes.
        [order(random, "lamp", "lamp", "lamp", late), 1.75, PAUSE],
        # A newer order, and then the person says yes to the older one, or never answers it.
        [order(random, "slowly", "done"), order(random, "lamp", "done"), PAUSE],
        [order(random, never, "done"), order(random, "walk", "done"), PAUSE],
        [order(random, "slowly", "done"), order(random, "promises", "done"), PAUSE],
        [order(random, "long", "done"), order(random, "yes", "done"), PAUSE],
    ]

    def tells(drawn: list[list[Text | float]]) -> bool:
        """Return True if a no follows a yes, and a yes a no."""
        yes = [row in rows[:2] for row in drawn if row in rows[:4]]
        return {(True, False), (False, True)} <= {*pairwise(yes)}

    return [step for row in drawn_until(lambda: shuffled(random, rows), tells) for step in row]


EXERCISE = ToolUser(
    "lab_2_6.confirms",
    "Lab 2.6 · A door that a person confirms",
    "Open a door only if a person says yes in time.",
    gives=steps,
    tells={"/said": "data"},
    asks={"/model": {"context": told}, "/lamp": "data", "/confirm": {"room": room}, "/door": {"room": room}},
    does={"/walk_to": ("x", "y")},
    cancels=["/walk_to"],
    serves={
        "/model": lambda _: reply,
        "/lamp": lambda _: [{"success": True}],
        "/confirm": lambda _: answer,
        "/door": lambda _: [Work(takes=OPENS, result={"reply": "open"})],
        "/walk_to": lambda _: walk,
    },
    every=True,
    pause=PAUSE,
    roles=("publisher", "subscription", "client", "action_client"),
).exercise(
    text={
        "asks `/confirm` whether to `open room 417?`": "confirm",
        "Only `yes` is a yes": "door",
        "Then it calls `/door` with the number of the room": "door model",
        "`error: door was denied`": "model",
        "gives up a question that has been open for more than 2 seconds": "model said",
        "Whatever the person says later opens nothing.": "door",
        "A newer order ends the question, too": "lamp walk_to walk_to/cancel",
    }
)
