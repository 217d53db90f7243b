"""The rate as a criterion and as a mistake, for who writes the scenario."""

from __future__ import annotations

import math

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.rules import another_rate, keeps_rate, rate_of


def heard(period: float, number: int = 10) -> Part:
    fields = {"fields": {"data": True}}
    return Part("met", {}, [Event(0.1, "message", "/alive", fields, 100 + n * period) for n in range(number)])


@pytest.mark.parametrize(
    ("seen", "passes", "says", "mistake"),
    [
        (heard(0.5), True, "one every 0.5 s", ""),
        (heard(1.0), False, "one every 1 s", "one every 1 s"),
        (heard(0.5, number=1), False, "1 message in all", ""),
        (Part("met"), False, "0 messages in all", ""),
    ],
    ids=["right", "too slow", "a single one", "silent"],
)
def test_the_references_rate_is_expected(seen: Part, passes: bool, says: str, mistake: str) -> None:
    finding = keeps_rate(seen, heard(0.5))
    assert (finding.passed, finding.expected, finding.seen) == (passes, "one every 0.5 s", says)
    assert another_rate(seen, heard(0.5)) == mistake


def test_an_author_is_told_that_the_reference_is_too_short_for_a_rate() -> None:
    with pytest.raises(ValueError, match="let the scenario run longer"):
        keeps_rate(heard(0.5), heard(0.5, number=2))


STEP = 0.05
"""Seconds by which the judge moves its clock."""


@pytest.mark.parametrize(
    ("period", "is_kept"), [(0.2, True), (0.18, False), (0.22, False), (0.25, False), (0.1, False)]
)
def test_between_inputs_a_timer_has_its_period_on_average(period: float, is_kept: bool) -> None:
    """The clock goes on in steps, so the usual interval of 0.18 s and of 0.22 s is 0.2 s, too."""
    inputs = [0.75, 1.5, 2.25, 3.0]
    rings = [math.ceil(round(n * period / STEP, 6)) * STEP for n in range(1, int(4 / period))]
    # It says something at each input, too, as a right one may.
    times = sorted([*rings, *inputs])
    messages = [Event(0.1, "message", "/cmd_vel", {}, 100 + time) for time in times]
    rate = rate_of(messages, 0.2, inputs=[100 + time for time in inputs])
    assert rate is not None
    assert rate.kept is is_kept
