"""Exercise 1.2: a client that adds three numbers with two calls of a service that adds two.

The judge serves. Its answers are not what the client could have added up by itself, so that the second call and the
reported sum show whether they were really used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit import service_calls
from autograder.kit.draft import Draft
from autograder.kit.model import Advice, Finding
from autograder.kit.recipes.service_client import Calls
from autograder.kit.recipes.service_runs import Run, hidden
from autograder.kit.service_calls import BIASED, CALLED, EXTREME, LATE, ClientSeen, answers, requests

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.evidence import Part


def runs(random: Random) -> tuple[Run, ...]:
    """A late service, a surprising one, and large numbers."""
    return (
        # 0 is a first answer here and a last one there, and no number that was asked for looks like the latter.
        Run(LATE, everyday(random), (0, -hidden(random))),
        # Negative in each check: an answer below zero is one like any other, too.
        Run(BIASED, negative(random), (-hidden(random), 0), held=1),
        Run(EXTREME, extreme(random), held=2),
    )


def everyday(random: Random) -> tuple[int, int, int]:
    """A number of everyday size and a zero, in any order, and a zero at the end: 0 is a number to be added, too."""
    first, second = random.sample((random.randint(1001, 99_999), 0), 2)
    return first, second, 0


def negative(random: Random) -> tuple[int, int, int]:
    """A negative number and two positive ones."""
    return -random.randint(1001, 99_999), random.randint(1001, 99_999), random.randint(1001, 99_999)


def extreme(random: Random) -> tuple[int, int, int]:
    """Numbers near both ends of an int64, whose sums stay inside it; the last sum is negative."""
    return (
        2**63 - 1 - random.randint(0, 999),
        -(2**62) - random.randint(1, 999),
        -(2**63) + random.randint(2001, 2999),
    )


def chained(part: Part) -> tuple[tuple[int, int], ...]:
    """The first call adds the first two numbers, the second its answer and the third number."""
    a, b, c = part.inputs["numbers"]
    return (a, b), *((total, c) for total in answers(part)[:1])


recipe = Calls(
    2,
    runs,
    # Not of the everyday kind: the sum of a number and zeros is that number, and a client may say what it will ask.
    (negative, extreme),
    wanted="first a + b, then that answer + c",
    right=chained,
)
adder = Draft(
    "exercise_1_2.three_ints",
    "Exercise 1.2 · Three numbers, two calls",
    "Add three numbers with two calls of a service that adds two.",
    recipe,
)


@adder.criterion("calls", 2, "Calls exactly twice")
def calls(seen: ClientSeen, expected: ClientSeen) -> Finding:
    """In each run it calls as often as the reference solution."""
    counts = [len(requests(part)) for part in seen.served]
    found = ", ".join(f"{count} ({name})" for count, name in zip(counts, CALLED, strict=True))
    return Finding(seen.called(expected.calls), f"{expected.calls} calls in each run", found)


adder.asks("chain", 3, "Builds the second call on the first answer", recipe.calls_right)
adder.asks("sum", 3, "Reports the final sum", service_calls.reports_the_sum)
adder.asks("late", 1, "Waits for a service that comes late", recipe.waits)
adder.asks("limit", 1, "Ends clearly when there is no service", service_calls.gives_up_in_time)


@adder.mistake("one_call_only", late=True, certain=ClientSeen.called_each_time)
def one_call_only(seen: ClientSeen, expected: ClientSeen) -> Advice | None:
    """The client ends by itself after one call or none."""
    part = next((p for p in seen.served if p.ending and len(requests(p)) < expected.calls), None)
    if part is None or not (seen.had_client or requests(part)):
        return None
    how_often = "once" if len(requests(part)) == 1 else "not at all"
    return Advice(
        f"Your client called the service {how_often}; the task asks for two calls.",
        "Call once with a and b, then again with the first answer and c. Lines below a raise or a return, and indented "
        "like it, are never reached.",
    )


EXERCISE = adder.exercise(
    limit=150.0,
    arguments="three whole numbers",
    remarks=(service_calls.no_limit,),
    sample_arguments=(1, 2, 3),
    text={
        "Wait for the service for `patience_sec` seconds.": "late limit",
        "raise `TimeoutError` then, with a message that contains `not available`": "limit",
        "you may also raise another exception, or log a line that contains `not available` and return `None`.": "limit",
        "Ask for the sum of `a` and `b`.": "calls chain",
        "Ask for the sum of that answer and `c`.": "calls chain",
        "Use the sum that the *service* gave you": "chain",
        "Log or print the sum, and return it.": "sum",
        "returning the sum is enough for the judge, and logging it alone is not.": "sum",
        "A program has to log or print it.": "sum",
        "it must say `not available` and end within 12 seconds, or say at least every three seconds": "limit",
    },
)
