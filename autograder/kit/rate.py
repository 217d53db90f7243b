"""The rate of the talker: by the simulated clock if the talker follows it, else by the talker's own clock.

In simulated time intervals are exact, so all of them count. In real time a message may be late on a busy machine, so
one in a row of messages may be late, and the judge waits for such a row. The times are the publisher's own, unless
they disagree with the times of arrival.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from statistics import mean, median
from typing import TYPE_CHECKING

from autograder.kit.in_words import counted
from autograder.kit.model import Finding

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Event, Part

ROW = 7
"""The number of successive messages that show a rate in real time."""
LATE = 6
"""One message in so many may be late."""
SIMULATED_TOLERANCE = 0.05
"""The share of the reference's interval by which the simulated mean may differ."""
SIMULATED_JITTER = 0.1
"""Simulated seconds by which one interval may differ: two steps of the judge's clock, or one long step."""
SLOWER, FASTER = 0.18, 0.1
"""The shares of the reference's interval by which the real median may differ: load makes a talker only slower."""
AT_ONCE = 0.1
"""Two messages form a burst if the time between them is less than this share of the period."""
UNEVEN = 0.3
"""An interval in real time is too long or too short if it differs from the period by more than this share of it."""
ON_THE_WAY = 0.3
"""Seconds that a message may travel; if it seems to take longer, or less than nothing, its time of sending is not
used.
"""
ROUNDING = 0.005
"""Seconds by which two readings of one clock may seem to be in the wrong order."""


@dataclass(frozen=True)
class Rate:
    """A measured rate.

    Attributes:
        period: The mean seconds between two messages.
        intervals: The seconds between each two.
        even: True if the intervals are equal, within the tolerance.
        kept: True if the rate is the required one.
    """

    period: float
    intervals: Sequence[float]
    even: bool
    kept: bool


def simulated(messages: Sequence[Event]) -> list[float]:
    """Return the simulated times of messages, if they follow that clock to the end.

    The first message is left out: the jump to simulated time distorts it.
    """
    follows = bool(messages) and messages[-1].sim is not None
    return [event.sim for event in messages if event.sim is not None][1:] if follows else []


def rate_of(messages: Sequence[Event], wanted: float, row: int = ROW) -> Rate | None:
    """Return the rate of messages; None if there are too few.

    Args:
        messages: The messages that the judge received.
        wanted: The reference's period, in seconds.
        row: The number of successive messages that must keep the rate in real time; the first such row counts.
    """
    if times := simulated(messages):
        return _exact(times, wanted) if len(times) > 1 else None
    sent = sent_times(messages)
    rows = [sent[i : i + row] for i in range(max(1, len(sent) - row + 1))] if len(sent) > 1 else []
    rates = [_at_a_glance(times, wanted) for times in rows]
    return next((rate for rate in rates if rate.kept), rates[-1] if rates else None)


def sent_times(messages: Sequence[Event]) -> list[float]:
    """Return the time at which each message was sent: the publisher's own time, if it is plausible.

    A busy judge receives messages late and close together, so the publisher's clock is better; but a publisher with a
    manipulated clock can report any time. Both read the clock of one machine.
    """
    return [_sent(event) for event in messages]


def _sent(event: Event) -> float:
    arrived = float(event.data.get("arrived", event.t))
    sent = float(event.data.get("sent", arrived))
    return sent if -ROUNDING <= arrived - sent <= ON_THE_WAY else arrived


def burst_at_the_start(messages: Sequence[Event], unheard: int, wanted: float) -> str:
    """Return what shows that a publisher began with a burst of messages, in words; else empty.

    messages: The messages that the judge received, from the first one that counts.
        messages: As the judge heard them, from the first that counts on.
        unheard: The number of earlier messages that the judge could not receive. At the right rate each took one
            period, so together at most the time since the program began.
        wanted: The reference's period, in seconds.
    """
    if not messages:
        return ""
    first = messages[0]
    arrived = float(first.data.get("arrived", first.t))
    # Only the publisher's clock is used: messages held up during discovery rightly arrive at once.
    in_real_time = (one for one in messages if one.sim is None or one is first)
    sent = [float(one.data.get("sent", one.data.get("arrived", one.t))) for one in in_real_time]
    since = sent[0] - (arrived - first.t)
    # The jump to simulated time may have moved the first received message forward.
    if (unheard - (first.sim is not None)) * wanted * (1 - FASTER) > since:
        return f"{counted(unheard + 1, 'message')} in the first {since:.1f} s"
    gaps = [after - before for before, after in pairwise(sent)]
    if not unheard and len(gaps) > 1 and max(gaps[:2]) < AT_ONCE * wanted:
        return "the first three messages came at once"
    return ""


def _exact(times: Sequence[float], wanted: float) -> Rate:
    gaps = [later - earlier for earlier, later in pairwise(times)]
    period = mean(gaps)
    even = all(abs(gap - period) <= SIMULATED_JITTER + 1e-6 for gap in gaps)
    return Rate(period, gaps, even, even and abs(period - wanted) <= SIMULATED_TOLERANCE * wanted)


def _at_a_glance(times: Sequence[float], wanted: float) -> Rate:
    gaps = [later - earlier for earlier, later in pairwise(times)]
    period, most = median(gaps), UNEVEN * wanted
    # A late message makes one interval longer, and the next one shorter if the timer keeps its schedule.
    even = all(
        sum(off > most for off in offs) <= len(gaps) // LATE
        for offs in ([gap - period for gap in gaps], [period - gap for gap in gaps])
    )
    near = (1 - FASTER) * wanted <= period <= (1 + SLOWER) * wanted
    return Rate(period if even else mean(gaps), gaps, even, even and near)


def confirmed(rate: Rate, before: Rate, wanted: float) -> bool:
    """True if a rate in real time shows the same wrong period as in simulated time.

    A thread that sleeps by that clock may seem slow, but only in simulated time.
    """
    wrong = abs(before.period - wanted) > SIMULATED_TOLERANCE * wanted
    return wrong and abs(rate.period - before.period) < abs(rate.period - wanted)


def keeps_rate(seen: Part, expected: Part) -> Finding:
    """Judge, for one topic, that messages come as often as the reference's.

    Raises:
        ValueError: The reference has no rate.
    """
    messages, wanted = seen.of("message"), _period(expected)
    rate = rate_of(messages, wanted)
    heard = f"one every {rate.period:.2g} s" if rate else f"{counted(len(messages), 'message')} in all"
    unevenly = " on average, but unevenly" if rate and not rate.even else ""
    return Finding(rate is not None and rate.kept, f"one every {wanted:.2g} s", heard + unevenly)


def another_rate(seen: Part, expected: Part) -> str:
    """Return how often it publishes on one topic if that is not the reference's rate; else an empty text."""
    rate = rate_of(seen.of("message"), _period(expected))
    return keeps_rate(seen, expected).seen if rate is not None and not rate.kept else ""


def _period(expected: Part) -> float:
    times = simulated(expected.of("message"))
    if len(times) < 2:
        raise ValueError("the reference has fewer than three messages in simulated time: let more time run")
    return (times[-1] - times[0]) / (len(times) - 1)
