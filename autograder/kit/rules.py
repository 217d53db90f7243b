"""Rules for a subject that publishes from time to time: the rate of its messages, and how contents are compared.

The rate is measured in simulated time if the subject follows it, otherwise in real time. In simulated time, intervals
are exact, so all of them count. But in real time, a busy machine may delay a message, so it is enough if several
successive messages have the right rate, and even one of these may be late. The times are those at which the publisher
says it sent the messages, unless the times of arrival contradict them.
"""

from __future__ import annotations

import ast
import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isclose, isnan
from statistics import mean, median, median_low
from typing import TYPE_CHECKING, Any

from autograder.kit.in_words import counted
from autograder.kit.model import Finding

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Part


ROW = 7
"""The number of successive messages that must have the right rate in real time."""
ONE_LATE_IN = 6
"""In real time, one message out of this many may be late."""
SIMULATED_TOLERANCE = 0.05
"""The tolerance for the mean interval in simulated time, as a fraction of the reference's interval."""
SIMULATED_JITTER = 0.1
"""The tolerance for a single interval, in simulated seconds: two steps, or one long step, because the judge moves its
clock in steps.
"""
SLOWER, FASTER = 0.18, 0.1
"""The tolerances for the median interval in real time, as fractions of the reference's interval. The tolerance for
slower talkers is larger, because load only makes a talker slower.
"""
BURST = 0.1
"""Two messages form a burst if the time between them is less than this fraction of the right interval."""
UNEVEN = 0.3
"""The tolerance for a single interval in real time, as a fraction of the right interval."""
ON_THE_WAY = 0.3
"""The maximum delay in seconds from sending to arrival. If the delay of a message is longer, or negative, its time of
sending is ignored.
"""
SUCCESSIVE, APART = 3, 0.3
"""The minimum number of endpoints that count as made again for each message, and the seconds between two of them."""
ROUNDING = 0.005
"""The number of seconds by which a message may seem to arrive before it was sent, because times are rounded."""


@dataclass(frozen=True)
class Rate:
    """The measured rate of a publisher.

    Attributes:
        period: The mean time between two messages, in seconds.
        intervals: The time between each two successive messages, in seconds.
        even: True if all intervals are equal, within the tolerance; in real time, almost all.
        kept: True if the measured rate is the right one, within the tolerance.
    """

    period: float
    intervals: Sequence[float]
    even: bool
    kept: bool


def simulated_times(messages: Sequence[Event]) -> list[float]:
    """Return the simulated time of each message; empty if the publisher did not follow the simulated clock to the end.

    The first message is left out, because the jump to simulated time distorts the message's time.
    """
    follows = bool(messages) and messages[-1].sim is not None
    return [event.sim for event in messages if event.sim is not None][1:] if follows else []


def rate_of(
    messages: Sequence[Event], wanted: float, row: int = ROW, *, inputs: Sequence[float] | None = None
) -> Rate | None:
    """Return the rate of a publisher's messages; None if there are too few messages.

    Args:
        messages: The messages that the judge received.
        wanted: The reference's interval, in seconds.
        inputs: In simulated time, the times at which something was given to a publisher that may publish once more
            then, or fall silent until then: the intervals around them do not count. None if all intervals count.
        row: Used only in real time, where messages may be late: the number of successive messages in a group. The
            result is the rate of the first group with the right rate; if no group has the right rate, the rate of the
            last group.
    """
    if times := simulated_times(messages):
        if inputs is not None:
            return _rate_between(inputs, times, wanted)
        return _exact_rate(times, wanted) if len(times) > 1 else None
    sent = sent_times(messages)
    rows = [sent[i : i + row] for i in range(max(1, len(sent) - row + 1))] if len(sent) > 1 else []
    rates = [_rate_in_real_time(times, wanted) for times in rows]
    return next((rate for rate in rates if rate.kept), rates[-1] if rates else None)


def sent_times(messages: Sequence[Event]) -> list[float]:
    """Return the time at which each message was sent: the publisher's own time if that is plausible.

    The publisher's times are better, because a busy judge receives messages late and close together. But a publisher
    could report a false time, so each time is compared with the time of arrival. They can be compared, because both
    processes read the clock of the same machine.
    """
    return [_sent_time(event) for event in messages]


def _sent_time(event: Event) -> float:
    arrived = float(event.data.get("arrived", event.t))
    sent = float(event.data.get("sent", arrived))
    return sent if -ROUNDING <= arrived - sent <= ON_THE_WAY else arrived


def burst_at_the_start(messages: Sequence[Event], unheard: int, wanted: float) -> str:
    """Return in words what shows that a publisher began with a burst of messages; empty if nothing does.

    Two facts show a burst: the first three messages came almost at once, or the judge missed more messages than a
    talker with the right rate can have sent since the program began.

    Args:
        messages: The messages that the judge received, from the first one that counts.
        unheard: The number of earlier messages, which the judge could not receive.
        wanted: The reference's interval, in seconds.
    """
    if not messages:
        return ""
    first = messages[0]
    arrived = float(first.data.get("arrived", first.t))
    # The times of arrival are not used, because messages that were held up during discovery arrive all at once.
    in_real_time = (one for one in messages if one.sim is None or one is first)
    sent = [float(one.data.get("sent", one.data.get("arrived", one.t))) for one in in_real_time]
    since = sent[0] - (arrived - first.t)
    # The jump to simulated time may have made the first received message come earlier.
    if (unheard - (first.sim is not None)) * wanted * (1 - FASTER) > since:
        return f"{counted(unheard + 1, 'message')} in the first {since:.1f} s"
    gaps = [after - before for before, after in pairwise(sent)]
    if not unheard and len(gaps) > 1 and max(gaps[:2]) < BURST * wanted:
        return "the first three messages came at once"
    return ""


def _exact_rate(times: Sequence[float], wanted: float) -> Rate:
    gaps = [later - earlier for earlier, later in pairwise(times)]
    period = mean(gaps)
    even = all(abs(gap - period) <= SIMULATED_JITTER + 1e-6 for gap in gaps)
    return Rate(period, gaps, even, even and abs(period - wanted) <= SIMULATED_TOLERANCE * wanted)


def _rate_between(inputs: Sequence[float], times: Sequence[float], wanted: float) -> Rate | None:
    gaps = [
        later - earlier
        for earlier, later in pairwise(times)
        if not any(earlier - SIMULATED_JITTER <= moment <= later for moment in inputs)
    ]
    if not gaps:
        return None
    middle = median_low(gaps)
    # The judge moves its clock in steps, so a period between two of them is only right on average.
    period = mean(gap for gap in gaps if abs(gap - middle) <= SIMULATED_JITTER)
    return Rate(period, gaps, True, abs(period - wanted) <= SIMULATED_TOLERANCE * wanted)


def _rate_in_real_time(times: Sequence[float], wanted: float) -> Rate:
    gaps = [later - earlier for earlier, later in pairwise(times)]
    period, most = median(gaps), UNEVEN * wanted
    # A late message makes one interval longer, and the next one shorter if the timer keeps its schedule.
    even = all(
        sum(off > most for off in offs) <= len(gaps) // ONE_LATE_IN
        for offs in ([gap - period for gap in gaps], [period - gap for gap in gaps])
    )
    near = (1 - FASTER) * wanted <= period <= (1 + SLOWER) * wanted
    return Rate(period if even else mean(gaps), gaps, even, even and near)


def confirmed(rate: Rate, before: Rate, wanted: float) -> bool:
    """Return True if a rate in real time confirms the wrong rate that was measured in simulated time.

    A thread that sleeps in real time may seem slow in simulated time although its real rate is right. In that case the
    result is False.
    """
    wrong = abs(before.period - wanted) > SIMULATED_TOLERANCE * wanted
    return wrong and abs(rate.period - before.period) < abs(rate.period - wanted)


def successive(part: Part, topic: str) -> int:
    """Return how many endpoints of the subject the judge met on a topic, one after another; 0 if they last.

    A program that makes a new endpoint for each message loses messages by chance, because each must be discovered.
    """
    moments = {int(event.moment / APART): event.data["count"] for event in part.of("matched", topic)}
    many = len(set(moments.values()))
    return many if many >= SUCCESSIVE else 0


def keeps_rate(seen: Part, expected: Part) -> Finding:
    """Decide whether the messages on a single topic come as often as the reference's.

    Raises:
        ValueError: The reference has too few messages to measure a rate.
    """
    messages, wanted = seen.of("message"), _reference_period(expected)
    return has_rate(messages, wanted, rate_of(messages, wanted))


def has_rate(messages: Sequence[Event], wanted: float, rate: Rate | None) -> Finding:
    """Return whether a publisher has the right rate, with the right rate and its own in words."""
    heard = f"one every {rate.period:.2g} s" if rate else f"{counted(len(messages), 'message')} in all"
    unevenly = " on average, but unevenly" if rate and not rate.even else ""
    return Finding(rate is not None and rate.kept, f"one every {wanted:.2g} s", heard + unevenly)


def another_rate(seen: Part, expected: Part) -> str:
    """Return the subject's rate in words if it is wrong; empty if it is right, or if there are too few messages."""
    rate = rate_of(seen.of("message"), _reference_period(expected))
    return keeps_rate(seen, expected).seen if rate is not None and not rate.kept else ""


def _reference_period(expected: Part) -> float:
    times = simulated_times(expected.of("message"))
    if len(times) < 2:
        raise ValueError(
            "the reference has fewer than three messages in simulated time: let the scenario run longer"
        )
    return (times[-1] - times[0]) / (len(times) - 1)


def value(event: Event) -> Any:
    """Return the content of a message, request or answer: its field ``data``, or all fields if it has no such field."""
    return event.data["fields"].get("data", event.data["fields"])


def value_of(text: str) -> Any:
    """Return the Python value that a subject's text stands for; None if it stands for none that Python can write."""
    # The documentation of literal_eval lists these errors, for texts that are not literals, or too deep or too long.
    with contextlib.suppress(ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        value = ast.literal_eval(text)
        repr(value)  # a number in another base may have more digits than Python writes
        return value
    return None


def same(one: Any, other: Any, tolerance: float = 1e-6) -> bool:
    """Return True if two contents, or lists of contents, are equal.

    Floating-point numbers may differ by ``tolerance`` (absolute, or relative to the larger one). NaN equals NaN.
    """
    if {type(one), type(other)} in ({float}, {float, int}):
        try:
            return (isnan(one) and isnan(other)) or isclose(one, other, rel_tol=tolerance, abs_tol=tolerance)
        except OverflowError:
            return False  # the int is larger than each float
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(same(one[key], other[key], tolerance) for key in one)
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(same(a, b, tolerance) for a, b in zip(one, other, strict=True))
    return bool(one == other)


def in_words(made: Sequence[object]) -> str:
    """Return a list of contents as one text for the card."""
    return ", ".join(f"{one:.10g}" if isinstance(one, float) else str(one) for one in made) or "nothing"
