"""A declared median filter: the output that is due after each input, and the outputs of wrong filters."""

from math import isfinite
from statistics import fmean, median
from typing import Any

from autograder.kit.recipes.relay import NAN, NUMBER, SILENCE, Relay


def due(
    ranges: list[float], of: Any = median, window: int = 5, enough: int = 3, counts: Any = isfinite
) -> Any:
    """Return what is due after the last of these ranges."""
    numbers = [*filter(counts, ranges)][-window:]
    return of(numbers) if len(numbers) >= enough and counts(ranges[-1]) else SILENCE


task = Relay(
    "filter.median",
    "A filter · The median of five",
    "Publish the median of the last five ranges that are numbers.",
    field="range",
    due=due,
    gives=[NUMBER] * 7 + [NAN, NUMBER, NAN, NAN, NUMBER, NUMBER],
    copies="header.stamp",
)
task.asks("listens", 2, "Subscribes to the right topic and type", "subscription", "Subscribe to `range`")
task.answers("median", 5, "Publishes the medians", "the median of the last five ranges that are numbers")
task.copies("stamp", 3, "Copies the stamp of the range that came last", "Copy the stamp")

IGNORE = "Leave the method at once if math.isnan(message.range)."
task.wrong("nan_counted", {"counts": bool}, "Your filter takes nan into its window.", IGNORE)
task.wrong(
    "nan_answered", lambda r: due([x for x in r if isfinite(x)]), "Your filter answers nan, too.", IGNORE
)
task.too_early("published_too_early")
task.wrong(
    "published_too_late", {"enough": 5}, "Your filter waits for five.", "Publish if len(self.window) >= 3."
)
task.wrong("mean_for_median", {"of": fmean}, "Your filter publishes the mean.", "Use statistics.median.")
task.wrong(
    "window_never_ends", {"window": 99}, "Your window never ends.", "Keep a collections.deque(maxlen=5)."
)
task.not_copied("stamp_not_copied")
EXERCISE = task.exercise()
