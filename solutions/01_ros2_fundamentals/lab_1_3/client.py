"""Lab 1.3: a client that has a service add two numbers and reports what it answered.

The judge serves, and its answers are not what the client could have added up by itself.
"""

from __future__ import annotations

from autograder.kit import Calls, Draft, giving_up, service_calls

recipe = Calls(1, wanted="one call with the two numbers, in each run")
client = Draft(
    "lab_1_3.client",
    "Lab 1.3 · A client that asks for a sum",
    "Have the service add_two_ints add two numbers, and report its answer.",
    recipe,
)
client.asks("call", "Calls once, with the two numbers", recipe.calls_right, points=4)
client.asks("sum", "Reports the sum that the service answered", service_calls.reports_the_sum, points=4)
client.asks("late", "Waits for a service that comes late", recipe.waits, points=1)
client.asks("limit", "Ends clearly when there is no service", service_calls.gives_up_in_time, points=1)

EXERCISE = client.exercise(
    limit=150.0,
    arguments="two whole numbers",
    remarks=(service_calls.no_limit,),
    sample_arguments=(1, 2),
    text={
        "Wait for the service for `patience_sec` seconds.": "late limit",
        "raise `TimeoutError` with a message that contains `not available`.": "limit",
        "Send the request, and spin the node until the answer has arrived": "call",
        "so wait until the future is done.": "call sum",
        "Log or print the sum that the server sent": "sum",
        "Return it, too": "sum",
        "at most `patience_sec` seconds": "",
        "Raise `TimeoutError` if there is no answer in time": "",
    },
    counts={
        "call": "The two numbers may come in either order. `call` beside a thread that spins counts as well.",
        "sum": service_calls.SUM_COUNTS,
        "limit": giving_up.COUNTS,
    },
)
