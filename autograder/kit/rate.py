"""The rate of the talker: by the simulated clock where it follows that one, else by its own.

In simulated time intervals are exact, so that all of them count. In real time a message may be late on a busy machine:
one may be among some messages in a row, and there is time for such a row. Their times are the publisher's own, unless
these disagree with the times of arrival.
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
"""Messages in a row that show a rate in real time."""
LATE = 6
"""One in so many messages of a row may be late."""
SIMULATED_TOLERANCE = 0.05
"""The part of the reference's interval by which the mean simulated one may differ."""
SIMULATED_JITTER = 0.1
"""Simulated seconds by which one interval may differ: two steps of the judge's clock, or a long one."""
SLOWER, FASTER = 0.18, 0.1
"""The parts of the reference's interval by which the median real one may differ: load makes a talker slower only."""
AT_ONCE = 0.1
"""The part of the period within which one message follows the other in a burst."""
UNEVEN = 0.3
"""The part of the period by which an interval in real time is too long or too short."""
ON_THE_WAY = 0.3
"""Seconds that a message may take; where it seems to take longer, or less than none, no time of sending is believed."""
ROUNDING = 0.005
"""Seconds by which two readings of one clock may seem to be in the wrong order."""


@dataclass(frozen=True)
class Rate:
    """A rate that was seen.

    Attributes:
        period: Seconds between two messages, as a whole.
        intervals: Seconds between each two.
        even: Whether these are the same, as far as can be expected.
        kept: Whether it is the one that is asked for.
    """

    period: float
    intervals: Sequence[float]
    even: bool
    kept: bool


def simulated(messages: Sequence[Event]) -> list[float]:
    """The simulated times of messages, where they follow that clock to the end.

    The first is left out: the jump to simulated time distorts it.
    """
    follows = bool(messages) and messages[-1].sim is not None
    return [event.sim for event in messages if event.sim is not None][1:] if follows else []


def rate_of(messages: Sequence[Event], wanted: float, row: int = ROW) -> Rate | None:
    """The rate of messages; None where there are too few for one.

    Args:
        messages: As the judge heard them.
        wanted: The reference's period, in seconds.
        row: Messages in a row that must keep to it in real time; the first such row counts.
    """
    if times := simulated(messages):
        return _exact(times, wanted) if len(times) > 1 else None
    sent = sent_times(messages)
    rows = [sent[i : i + row] for i in range(max(1, len(sent) - row + 1))] if len(sent) > 1 else []
    rates = [_at_a_glance(times, wanted) for times in rows]
    return next((rate for rate in rates if rate.kept), rates[-1] if rates else None)


def sent_times(messages: Sequence[Event]) -> list[float]:
    """The time at which each message was sent: as its publisher says, where that can be true.

    A busy judge hears messages late and close together, so their publisher's clock is the better one; but a publisher
    whose clock was tampered with says what it likes. Both read the clock of one machine.
    """
    return [_sent(event) for event in messages]


def _sent(event: Event) -> float:
    arrived = float(event.data.get("arrived", event.t))
    sent = float(event.data.get("sent", arrived))
    return sent if -ROUNDING <= arrived - sent <= ON_THE_WAY else arrived


def burst_at_the_start(messages: Sequence[Event], unheard: int, wanted: float) -> str:
    """What shows that a publisher began with a burst of messages, in words; else empty.

    Args:
        messages: As the judge heard them, from the first that counts on.
        unheard: The number of messages before these that nobody could hear. They took a period each; more time than has
            passed since the publisher's program began they cannot take.
        wanted: The reference's period, in seconds.
    """
    if not messages:
        return ""
    first = messages[0]
    arrived = float(first.data.get("arrived", first.t))
    # By the publisher's clock alone: what was held up while the two ends met arrives at once, and rightly so.
    in_real_time = (one for one in messages if one.sim is None or one is first)
    sent = [float(one.data.get("sent", one.data.get("arrived", one.t))) for one in in_real_time]
    since = sent[0] - (arrived - first.t)
    # The jump to simulated time may have brought the first one that was heard forward.
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
    # A late message makes one interval longer, and the next one shorter where a timer keeps to its time.
    even = all(
        sum(off > most for off in offs) <= len(gaps) // LATE
        for offs in ([gap - period for gap in gaps], [period - gap for gap in gaps])
    )
    near = (1 - FASTER) * wanted <= period <= (1 + SLOWER) * wanted
    return Rate(period if even else mean(gaps), gaps, even, even and near)


def confirmed(rate: Rate, before: Rate, wanted: float) -> bool:
    """True if a rate in real time shows the same wrong period as the simulated clock did.

    A thread that sleeps by that clock may seem slow in simulated time, and only there.
    """
    wrong = abs(before.period - wanted) > SIMULATED_TOLERANCE * wanted
    return wrong and abs(rate.period - before.period) < abs(rate.period - wanted)


def keeps_rate(seen: Part, expected: Part) -> Finding:
    """A criterion for one topic: the messages come as often as the reference's.

    Raises:
        ValueError: The reference has no rate.
    """
    messages, wanted = seen.of("message"), _period(expected)
    rate = rate_of(messages, wanted)
    heard = f"one every {rate.period:.2g} s" if rate else f"{counted(len(messages), 'message')} in all"
    unevenly = " on average, but unevenly" if rate and not rate.even else ""
    return Finding(rate is not None and rate.kept, f"one every {wanted:.2g} s", heard + unevenly)


def another_rate(seen: Part, expected: Part) -> str:
    """A mistake for one topic: how often it publishes, where that is not the reference's rate; else an empty text."""
    rate = rate_of(seen.of("message"), _period(expected))
    return keeps_rate(seen, expected).seen if rate is not None and not rate.kept else ""


def _period(expected: Part) -> float:
    times = simulated(expected.of("message"))
    if len(times) < 2:
        raise ValueError("the reference has fewer than three messages in simulated time: let more time run")
    return (times[-1] - times[0]) / (len(times) - 1)
