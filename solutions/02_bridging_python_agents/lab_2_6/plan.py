"""Lab 2.6, a plan that takes time: call after call within a budget, and a newer order ends what the older one began."""

from random import Random

from lab_2_6._model import order, reply, told, walk

from autograder.kit import Text, ToolUser, drawn_until, shuffled

PAUSE = 3.0
"""Seconds of the subject's time after each input. All but the quiet walk and the slow reply are over by then."""


def steps(random: Random) -> list[Text]:
    """Return rows in drawn order: plans that end well, badly, or never, and plans that a newer order ends."""
    after = [["lamp", "done"], ["walk", "done"], ["blocked", "lamp", "done"]]
    newer = [order(random, *kinds) for kinds in shuffled(random, after)]
    rows = [
        [order(random, "lamp", "done")],
        [order(random, "walk", "lamp", "far", "done")],
        [order(random, random.choice(("blocked", "refused")), "walk", "done")],
        [order(random, random.choice(("nan", "fly")), "slow", "done")],
        [order(random, "stuck", "walk", "done")],
        [order(random, "walk", "away", "done")],
        used_up := [order(random, *shuffled(random, ("walk", "blocked", "lamp", "fly")), "lamp", "done")],
        [order(random, "quiet", "done"), newer[0]],
        [order(random, "lamp", "quiet", "done"), newer[1]],
        [order(random, "walk", takes=3.6), newer[2]],
    ]
    # A node that has given up once begins a plan as before.
    drawn = drawn_until(lambda: shuffled(random, rows), lambda drawn: drawn[-1] is not used_up)
    return [step for row in drawn for step in row]


EXERCISE = ToolUser(
    "lab_2_6.plan",
    "Lab 2.6 · A plan that takes time",
    "Do call after call within a budget, and leave the plan when a newer order comes.",
    gives=steps,
    tells={"/said": "data"},
    asks={"/model": {"context": told}, "/lamp": "data"},
    does={"/walk_to": ("x", "y")},
    cancels=["/walk_to"],
    serves={
        "/model": lambda _: reply,
        "/lamp": lambda _: [{"success": True}],
        "/walk_to": lambda _: walk,
    },
    every=True,
    pause=PAUSE,
    roles=("publisher", "subscription", "client", "action_client"),
).exercise(
    text={
        "adds a line to `self.prompt`": "model",
        "After the fourth, it asks no more, and `say`s `I give up`.": "said model",
        "cancels the goal that runs, if one does": "walk_to/cancel",
        "Then it calls `begin` with the text of the order.": "model lamp walk_to",
        "If it is not less than the last time, it cancels the goal.": "walk_to/cancel",
    }
)
