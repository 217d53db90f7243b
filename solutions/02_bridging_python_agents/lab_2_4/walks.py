"""Lab 2.4, a tool that takes time: the answer comes when the walk is over, and says how it ended."""

from itertools import pairwise
from random import Random
from typing import Any

from lab_2_4._calls import lamp, not_finite, out_of_range, outcome, place, say, walk, wrong_types

from autograder.kit import Text, ToolUser, Work, drawn_until, shuffled

ENDS = ("succeeded", "succeeded", "succeeded", "aborted", "canceled", "rejected", "rejected")
"""How the walks end."""
WALK = "error: walk_to"


def steps(random: Random) -> list[Text]:
    """Return calls in drawn order, of which seven walk."""
    calls = [
        *(walk(*place(random)) for _ in ENDS[1:]),
        walk(random.randint(1, 5), random.randint(1, 3)),
        lamp(random.choice((True, False))),
        say(random),
        random.choice(not_finite(random)),
        random.choice(wrong_types(random)[4:8]),
        random.choice(out_of_range(random)[:5]),
    ]
    return [Text("/call", call) for call in shuffled(random, calls)]


def tells(ends: list[str]) -> bool:
    """Return True if a rejected walk and an accepted one follow each, and of those a good and a bad one do, too."""
    accepted = [end for end in ends if end != "rejected"]
    orders = [end == "rejected" for end in ends], [end == "succeeded" for end in accepted]
    return all(len({*pairwise(order)}) == 4 for order in orders)


def walks(random: Random) -> list[Work]:
    """Return how the walks end, and when."""
    return [
        Work(end, round(random.uniform(0.2, 0.4), 2), [{"distance": 1.0}], {"arrived": end == "succeeded"})
        for end in drawn_until(lambda: shuffled(random, ENDS), tells)
    ]


def told(fields: dict[str, Any]) -> str:
    """Return what an answer says, and whether it says of a walk how it ended."""
    says = outcome(fields)
    ended = says != WALK or len(fields["data"].split()) > len(WALK.split())
    return says if ended else f"{says}, and not how it ended"


EXERCISE = ToolUser(
    "lab_2_4.walks",
    "Lab 2.4 · A tool that takes time",
    "Walk where a call says, and answer when the walk is over.",
    gives=steps,
    tells={"/result": {"answer": told}, "/speech": "data"},
    asks={"/lamp": "data"},
    does={"/walk_to": ("x", "y")},
    serves={"/lamp": lambda _: [{"success": True}], "/walk_to": walks},
    every=True,
    roles=("publisher", "subscription", "client", "action_client"),
).exercise(
    text={
        "it sends the goal to the action `walk_to`, without waiting": "walk_to",
        "The answer comes once, and only when all is over": "result",
        "`ok` if the walk has": "result",
        "even if the goal is rejected": "result",
        "Write `walk_to`": "speech lamp",
    }
)
