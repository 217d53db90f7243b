"""A service client: has a service add two distances, and reports the answer."""

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
    """Draw a late service, an unexpected answer that is held back for a moment, and large numbers."""
    late = Run(LATE, distances(random), (-hidden(random),))
    return late, Run(BIASED, distances(random), (0,), held=1), Run(EXTREME, far(random))


def distances(random: Random) -> tuple[int, int]:
    """Two numbers of everyday size."""
    first, second = random.sample(range(1001, 99_999), 2)
    return first, second


def far(random: Random) -> tuple[int, int]:
    """A large number and a small one, whose sum stays inside an int64."""
    return 2**63 - 1 - random.randint(5000, 9999), random.randint(1, 4999)


recipe = Calls(1, runs, (distances, far), wanted="one call with the two distances, in each run")
odometer = Draft(
    "service_client.odometer",
    "A service client · The odometer",
    "Have the service add_distances add two distances, and report its answer.",
    recipe,
)


odometer.asks("call", 4, "Calls once, with the two distances", recipe.calls_right)
odometer.asks("sum", 4, "Reports the sum that the service answered", service_calls.reports_the_sum)
odometer.asks("limit", 2, "Ends clearly when there is no service", service_calls.gives_up_in_time)


EXERCISE = odometer.exercise(
    limit=150.0,
    arguments="two whole numbers",
    remarks=(service_calls.no_limit,),
    sample_arguments=(1, 2),
)
