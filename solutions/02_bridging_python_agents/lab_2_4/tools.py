"""Lab 2.4, tools that speak and switch the lamp: right calls are done, and wrong ones send nothing."""

from itertools import pairwise
from random import Random
from typing import Any

from lab_2_4._calls import lamp, no_calls, not_finite, outcome, say, unknown_tools, walk, wrong_types

from autograder.kit import Text, ToolUser, Work, drawn_until, mixed, shuffled
from autograder.kit.oracle.same_as_solution import PAUSE

LAMP = "error: lamp"


def steps(random: Random) -> list[Text]:
    """Return calls in drawn order, more right ones than wrong ones. Something is said twice in a row."""
    again = say(random)
    calls = [
        *(lamp(on) for on in (True, True, False, False, random.choice((True, False)))),
        *(again, again, say(random, "Hello, world! ")),
        random.choice(no_calls(random)),
        *unknown_tools(random)[:-1],
        wrong_types(random)[0],
        random.choice(not_finite(random)),
        walk(random.randrange(20, 90), 1),
    ]
    order = drawn_until(
        lambda: shuffled(random, calls),
        lambda order: (again, again) in pairwise(call for call in order if '"say"' in call),
    )
    return [Text("/call", call) for call in order]


def lamps(random: Random) -> list[Any]:
    """Return what the lamp answers: it is out of order now and then, each time for a reason of its own.

    The first answer comes after the next call, in the middle of its step.
    """
    works = mixed(random, (True, True, False, False, random.choice((True, False))), bool)
    # A success may have a message, too.
    says = {False: ["no power in"] * 3, True: shuffled(random, ["power in", "", "current flows in"])}
    texts = [says[success].pop() for success in works]
    first, *others = [
        {"success": success, "message": text and f"{text} line {random.randrange(100, 1000)}"}
        for success, text in zip(works, texts, strict=True)
    ]
    return [Work(takes=1.5 * PAUSE, result=first), *others]


def told(fields: dict[str, Any]) -> str:
    """Return what an answer says, and of the lamp the number of the line."""
    says = outcome(fields)
    return says + " " * (says == LAMP) + "".join(filter(str.isdigit, fields["data"] if says == LAMP else ""))


EXERCISE = ToolUser(
    "lab_2_4.tools",
    "Lab 2.4 · Do it",
    "Do a right call, and answer each call with what came of it.",
    gives=steps,
    tells={"/result": {"answer": told}, "/speech": "data"},
    asks={"/lamp": "data"},
    serves={"/lamp": lamps},
    every=True,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "`on_call` answers a wrong call with `error: ` and what `find_fault` says": "result",
        "**and sends nothing else**": "speech lamp",
        "`say` publishes a text on `speech`, and answers `ok`.": "speech result",
        "`lamp` calls the service `lamp` and does not wait.": "lamp",
        "the answer to the model is `ok` if its `success` is true": "result",
    }
)
