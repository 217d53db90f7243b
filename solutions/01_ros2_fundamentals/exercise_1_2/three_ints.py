"""Exercise 1.2: a client that adds three numbers with two calls of a service that adds two.

The judge serves. Its answers are not what the client could have added up by itself, so that the second call and the
reported sum show whether they were really used.
"""

from __future__ import annotations

from autograder.kit import Calls, Draft, Finding, giving_up, service_calls
from autograder.kit.service_calls import ClientSeen, requests

recipe = Calls(2, wanted="first a + b, then that answer + c")
adder = Draft(
    "exercise_1_2.three_ints",
    "Exercise 1.2 · Three numbers, two calls",
    "Add three numbers with two calls of a service that adds two.",
    recipe,
)


@adder.criterion("calls", "Calls exactly twice", points=2)
def calls(seen: ClientSeen, expected: ClientSeen) -> Finding:
    """In each run it calls as often as the reference solution."""
    found = ", ".join(f"{len(requests(part))} ({part.name})" for part in seen.served)
    return Finding(seen.called(expected.calls), f"{expected.calls} calls in each run", found)


adder.asks("chain", "Builds the second call on the first answer", recipe.calls_right, points=3)
adder.asks("sum", "Reports the final sum", service_calls.reports_the_sum, points=3)
adder.asks("late", "Waits for a service that comes late", recipe.waits, points=1)
adder.asks("limit", "Ends clearly when there is no service", service_calls.gives_up_in_time, points=1)


def called_less(seen: ClientSeen, expected: ClientSeen) -> str:
    """Return in words how often a client called that ended by itself before its second call."""
    part = next((p for p in seen.served if p.ending and len(requests(p)) < expected.calls), None)
    if part is None or not (seen.had_client or requests(part)):
        return ""
    return "once" if requests(part) else "not at all"


adder.knows(
    "one_call_only",
    called_less,
    "Your client called the service {}; the task asks for two calls.",
    "Call once with a and b, then again with the first answer and c. Lines below a raise or a return, and indented "
    "like it, are never reached.",
    late=True,
    certain=ClientSeen.called_each_time,
)

EXERCISE = adder.exercise(
    limit=150.0,
    arguments="three whole numbers",
    remarks=(service_calls.no_limit,),
    sample_arguments=(1, 2, 3),
    text={
        "Wait for the service for `patience_sec` seconds.": "late limit",
        "raise `TimeoutError` then, with a message that contains `not available`": "limit",
        "Ask for the sum of `a` and `b`.": "calls chain",
        "Ask for the sum of that answer and `c`.": "calls chain",
        "Use the sum that the *service* gave you": "chain",
        "Log or print the sum, and return it.": "sum",
        "Do not catch it": "",
    },
    counts={
        "chain": "The two numbers of a call may come in either order.",
        "sum": service_calls.SUM_COUNTS,
        "limit": giving_up.COUNTS,
    },
)
