"""Lab 2.5, a model that is asked again: a wrong reply sends nothing, and the reason goes back."""

from random import Random

from lab_2_5._model import kind, order, reply, told

from autograder.kit import Text, ToolUser, Work, shuffled

WRONG = ("sign", "fenced", "chat", "nan", "infinite", "far", "unknown", "text")
"""The kinds of wrong replies."""


def steps(random: Random) -> list[Text]:
    """Return orders in drawn order: good at once, at the second try, at the third, and never. Each fault comes once."""
    faults = shuffled(random, WRONG)
    kinds = [
        *(kind("good") for _ in range(3)),
        *(kind(fault, "good") for fault in faults[:3]),
        kind(*faults[3:5], "good"),
        kind(*faults[5:8]),
        kind(*faults[:3]),
    ]
    return [Text("/order", order(random, one)) for one in shuffled(random, kinds)]


EXERCISE = ToolUser(
    "lab_2_5.asks",
    "Lab 2.5 · Ask again, and say why",
    "Do what the model says if it is right; else ask again with the reason, at most twice.",
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
    roles=("publisher", "subscription", "client", "action_client"),
).exercise(
    text={
        "it calls `/model` with `self.prompt`, without waiting": "model",
        "`do` the call and `say` the text `done`": "said lamp walk_to",
        "add a line to the prompt, `error: ` and what was found, and ask again": "model",
        "give up: do nothing, and `say` the text `I do not understand`": "said lamp walk_to",
    }
)
