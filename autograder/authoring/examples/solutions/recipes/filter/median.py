"""A median filter, declared: what is due after each input, and what wrong filters make of it."""

from __future__ import annotations

import math
from statistics import fmean, median
from typing import TYPE_CHECKING

from autograder.kit.recipes.declared import NAN, SILENCE, Relay

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from random import Random


def due(
    ranges: Sequence[float],
    of: Callable[[Sequence[float]], float] = median,
    window: int = 5,
    enough: int = 3,
) -> object:
    """What is due after the last of these ranges."""
    numbers = [r for r in ranges if not math.isnan(r)][-window:]
    return of(numbers) if len(numbers) >= enough and not math.isnan(ranges[-1]) else SILENCE


def ranges(random: Random) -> list[float]:
    """Numbers that nobody can guess, and three that are none."""
    some = [n / 4 for n in random.sample(range(4, 400), 10)]
    return [*some[:7], NAN, some[7], NAN, NAN, *some[8:]]


task = Relay(
    "filter.median",
    "A filter · The median of five",
    "Publish the median of the last five ranges that are numbers.",
    field="range",
    gives=ranges,
    due=due,
    copies="header.stamp",
)
task.asks("listens", 2, "Subscribes to the right topic and type", "subscription", "Subscribe to `range`")
task.answers(
    "median", 5, "Publishes the medians, in order", "the median of the last five ranges that are numbers"
)
task.copies("stamp", 3, "Copies the stamp of the range that came last", "Copy the stamp")

IGNORE = "Leave the method at once if math.isnan(message.range)."
task.wrong(
    "nan_counted",
    lambda r: median(r[-5:]) if len(r) > 2 else SILENCE,
    "Your filter takes ranges that are no number into its window.",
    IGNORE,
)
task.wrong(
    "nan_answered",
    lambda r: due([x for x in r if x == x]) if len(r) > 2 else SILENCE,
    "Your filter publishes once more where a range is no number.",
    IGNORE,
)
task.wrong(
    "published_too_early",
    lambda r: due(r, enough=1),
    "Your filter publishes before it has heard three ranges.",
    "Publish only if len(self.window) >= 3.",
)
task.wrong(
    "published_too_late",
    lambda r: due(r, enough=5),
    "Your filter waits for five ranges; three are enough.",
    "Publish as soon as len(self.window) >= 3.",
)
task.wrong(
    "mean_for_median",
    lambda r: due(r, of=fmean),
    "Your filter publishes the mean of the last five ranges.",
    "Use statistics.median.",
)
task.wrong(
    "window_never_ends",
    lambda r: due(r, window=99),
    "Your filter takes all ranges that it ever heard.",
    "Keep them in collections.deque(maxlen=5).",
)
task.not_copied(
    "stamp_not_copied", "Your messages have no stamp.", "Copy it: out.header.stamp = message.header.stamp."
)
EXERCISE = task.exercise()
