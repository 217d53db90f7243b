"""Lab 1.3: a client that has a service add two numbers and reports what it answered.

The judge serves, and its answers are not what the client could have added up by itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit import service_calls
from autograder.kit.draft import Draft
from autograder.kit.recipes.service_client import Calls
from autograder.kit.recipes.service_runs import Run, hidden
from autograder.kit.service_calls import BIASED, EXTREME, LATE

if TYPE_CHECKING:
    from random import Random


def runs(random: Random) -> tuple[Run, ...]:
    """A late service, a surprising one, and large numbers."""
    return (
        Run(LATE, everyday(random), (-hidden(random),)),
        # 0 is an answer like any other, and neither of the numbers looks like it.
        Run(BIASED, negative(random), (0,)),
        # Another answer is held back: a client that does not wait for it must differ from one that takes 0 for none.
        Run(EXTREME, extreme(random), held=1),
    )


def everyday(random: Random) -> tuple[int, int]:
    """A number of everyday size and a zero, in any order."""
    first, second = random.sample((random.randint(1001, 99_999), 0), 2)
    return first, second


def negative(random: Random) -> tuple[int, int]:
    """A negative number and a positive one."""
    return -random.randint(1001, 49_999), random.randint(50_001, 99_999)


def extreme(random: Random) -> tuple[int, int]:
    """Numbers near both ends of an int64, whose sum is negative and stays inside it."""
    return 2**62 - 1 - random.randint(0, 999), -(2**63) + random.randint(0, 999)


recipe = Calls(
    1,
    runs,
    # Not of the everyday kind: with a zero the sum is one of the numbers, and a client may say what it will ask.
    (negative, extreme),
    wanted="one call with the two numbers, in each run",
)
client = Draft(
    "lab_1_3.client",
    "Lab 1.3 · A client that asks for a sum",
    "Have the service add_two_ints add two numbers, and report its answer.",
    recipe,
)


client.asks("call", 4, "Calls once, with the two numbers", recipe.calls_right)
client.asks("sum", 4, "Reports the sum that the service answered", service_calls.reports_the_sum)
client.asks("late", 1, "Waits for a service that comes late", recipe.waits)
client.asks("limit", 1, "Ends clearly when there is no service", service_calls.gives_up_in_time)


EXERCISE = client.exercise(
    limit=150.0,
    arguments="two whole numbers",
    remarks=(service_calls.no_limit,),
    sample_arguments=(1, 2),
    text={
        "Wait for the service for `patience_sec` seconds.": "late limit",
        "raise `TimeoutError` with a message that contains `not available`.": "limit",
        "you may also raise another exception, or log a line that contains `not available` and return `None`.": "limit",
        "Send the request, and spin the node until the answer has arrived": "call",
        "so wait until the future is done.": "call sum",
        "Log or print the sum that the server sent": "sum",
        "Return it, too": "sum",
        "returning the sum is enough for the judge, and logging it alone is not.": "sum",
        "A program has to log or print it.": "sum",
        "it must say `not available` and end within 12 seconds, or say at least every three seconds": "limit",
    },
)
