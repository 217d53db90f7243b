"""The rate as a criterion and as a mistake, for who writes the scenario."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.rules import another_rate, keeps_rate


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
