"""A subscriber: warns of low charges, and of nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit import Draft, Finding, OwnScenario
from autograder.kit.bench import Pace
from autograder.kit.recipes.own_scenario import Met, once_met

if TYPE_CHECKING:
    from random import Random

    from autograder.kit import Part

LIMIT = 20
"""The lowest charge without a warning, in percent."""
PATIENCE = {Pace.FAST: 1.5, Pace.REAL_TIME: 5.0}
"""Seconds of wall time within which the last warning must have come."""


def listening(met: Met) -> bool:
    """Publish charges on both sides of the limit; the last one is low, so that its warning shows the end."""
    for charge in charges(met.bench.random):
        met.speakers[0].send(data=charge)
    return met.bench.wait_until(lambda evidence: not missing(evidence.main), PATIENCE[met.bench.pace])


def charges(random: Random) -> list[int]:
    """Seven charges, no more than a queue of 10 holds: three high ones, the limit, three low ones."""
    some = [*random.sample(range(LIMIT + 1, 100), 3), LIMIT, *random.sample(range(1, LIMIT), 2)]
    random.shuffle(some)
    return [*some, random.choice([low for low in range(1, LIMIT) if low not in some])]


guard = Draft(
    "subscriber.guard",
    "A subscriber · The battery's guard",
    "Warn of each charge below 20 percent, and of no other.",
    subject := OwnScenario(once_met(listening), "subscription"),
)
guard.asks(
    "topic", "Subscribes to the right topic, with the right type", subject.has("subscription"), points=2
)


def sent(seen: Part) -> list[int]:
    """Return the charges that the judge published."""
    return [event.data["fields"]["data"] for event in seen.of("sent")]


def named(seen: Part) -> list[set[int]]:
    """Return, for each line that was said, the charges in it."""
    charges_sent = set(sent(seen))
    return [charges_sent & {int(number) for number in re2.findall(r"\d{1,3}", line)} for line in seen.said()]


def missing(seen: Part) -> list[int]:
    """Return the low charges without a warning."""
    return [c for c in sent(seen) if c < LIMIT and not any(c in line for line in named(seen))]


def needless(seen: Part) -> list[int]:
    """Return the other charges with a warning: a line may name the limit next to a low charge."""
    return [c for line in named(seen) for c in sorted(line) if min(line) >= LIMIT]


@guard.criterion("warns", "Warns of each low charge", points=4)
def warns(seen: Part, _: Part) -> Finding:
    """Each low charge is in something that was said."""
    silent = [f"no word of {charge}" for charge in missing(seen)]
    return Finding(bool(sent(seen)) and not silent, "a line for each", ", ".join(silent) or "a line for each")


@guard.criterion("only", "Says nothing of any other charge", points=4)
def only(seen: Part, _: Part) -> Finding:
    """No other charge is in what was said, if anything was said."""
    told = ", ".join(map(str, needless(seen)))
    return Finding(
        any(named(seen)) and not told, "20 percent and more pass in silence", told or "none of them"
    )


guard.knows(
    "limit_included",
    lambda seen, _: set(needless(seen)) == {LIMIT},
    "Your node warns of 20 percent too.",
    "Compare with <.",
    certain=True,
)


EXERCISE = guard.exercise()
