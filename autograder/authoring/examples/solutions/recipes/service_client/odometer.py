"""A service client: has a service add two distances, and reports the answer."""

from __future__ import annotations

from autograder.kit import Calls, Draft, service_calls

recipe = Calls(1, wanted="one call with the two distances, in each run")
odometer = Draft(
    "service_client.odometer",
    "A service client · The odometer",
    "Have the service add_distances add two distances, and report its answer.",
    recipe,
)
odometer.asks("call", "Calls once, with the two distances", recipe.calls_right, points=4)
odometer.asks("sum", "Reports the sum that the service answered", service_calls.reports_the_sum, points=4)
odometer.asks("limit", "Ends clearly when there is no service", service_calls.gives_up_in_time, points=2)

EXERCISE = odometer.exercise(
    limit=150.0,
    arguments="two whole numbers",
    remarks=(service_calls.no_limit,),
    sample_arguments=(1, 2),
)
