"""Lab 2.4, the check of a call: the field that is wrong, or nothing."""

import json
from random import Random

from lab_2_4._calls import (
    WORDS,
    lamp,
    no_calls,
    not_finite,
    out_of_range,
    place,
    say,
    unknown_tools,
    walk,
    wrong_types,
)

from autograder.kit import Returns, shuffled


def calls(random: Random) -> list[str]:
    """Return calls in drawn order, of which a third can be done."""
    right = [
        *(lamp(on) for on in (True, False)),
        *(walk(*place(random)) for _ in range(3)),
        walk(random.randint(1, 5), random.randint(1, 3)),
        walk(*random.choice(((0, 4), (6, 0), (0.0, 0), (6.0, 4.0)))),
        *(say(random) for _ in range(3)),
        json.dumps({"tool": "lamp", "on": True, "text": random.choice(WORDS), "x": 9}),
        json.dumps({"tool": "say", "text": random.choice(WORDS), "on": "yes", "y": float("nan")}),
    ]
    wrong = [
        call
        for kind in (no_calls, unknown_tools, wrong_types, out_of_range, not_finite)
        for call in kind(random)
    ]
    # One of no_calls may be null, which a function that asks only for None finds, too.
    wrong.append(random.choice(("[]", "3", "true")))
    return shuffled(random, [*right, *wrong])


EXERCISE = Returns(
    "lab_2_4.checks",
    "Lab 2.4 · Check it",
    "Return the field that is wrong in a call, or an empty text.",
    gives=calls,
).exercise(
    text={
        'For a call that can be done it returns `""`.': "returned",
        "and the first word is the name of the field": "returned",
        "Further fields do not matter.": "returned",
    }
)
