"""Lab 2.4, the check of a call: the field that is wrong, or nothing."""

from random import Random

from lab_2_4._calls import (
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
    ]
    wrong = [
        call
        for kind in (no_calls, unknown_tools, wrong_types, out_of_range, not_finite)
        for call in kind(random)
    ]
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
    }
)
