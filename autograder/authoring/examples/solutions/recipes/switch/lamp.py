"""A switch: a publisher that a service std_srvs/srv/SetBool switches on and off."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Finding
from autograder.kit.recipes.own_scenario import Met, OwnScenario, once_met

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

PHASES = ("before it was switched on", "on", "off again", "on again")
LISTENS = 1.0
"""Seconds of the subject's time for which nothing may come: five times the period."""
PATIENCE, ENOUGH = 3.0, 3
"""Seconds of the subject's time in which so many messages must have come while it is on."""


def switching(met: Met) -> bool:
    """Listen before it is switched on, while it is on, off, and on again."""
    met.bench.run_time(LISTENS)
    return all(is_switched(met, on) for on in (True, False, True))


def is_switched(met: Met, on: bool) -> bool:
    """Switch it and listen. Return True if it answered, and published if it is on."""
    (caller,) = met.callers
    caller.ask({"data": on})
    answered = caller.await_answers(PATIENCE)
    enough = met.heard + ENOUGH
    met.bench.run_time(PATIENCE if on else LISTENS, until=lambda: on and met.heard >= enough)
    return answered and (not on or met.heard >= enough)


lamp = Draft(
    "switch.lamp",
    "A switch · The lamp",
    "Publish only while the service lamp has switched it on.",
    subject := OwnScenario(once_met(switching), "publisher", "service"),
)
lamp.asks("service", 1, "Serves the right service and type", subject.has("service"))


def heard(seen: Part) -> list[int]:
    """How many messages came in each phase. After the lamp was switched off, one may have been on its way."""
    counts = [0]
    for event in seen.events:
        counts += [0] * (event.kind == "answered")
        counts[-1] += event.kind == "message"
    return [count - (phase == 2 and count > 0) for phase, count in enumerate(counts)]


@lamp.criterion("answers", 2, "Answers each call with success")
def answers(seen: Part, _: Part) -> Finding:
    """Each of the three calls is answered, and successful."""
    told = [event.data["fields"]["success"] for event in seen.of("answered")]
    return Finding(told == [True] * 3, "three times success", ", ".join(map(str, told)) or "no answer")


@lamp.criterion("on", 3, "Publishes while it is on")
def on(seen: Part, _: Part) -> Finding:
    """Messages come in both phases in which it is on."""
    counts = heard(seen)
    shown = ", ".join(f"{count} {phase}" for phase, count in zip(PHASES, counts, strict=False))
    return Finding(len(counts) == 4 and min(counts[1::2]) >= ENOUGH - 1, "messages each time", shown)


@lamp.criterion("off", 4, "Is silent while it is off")
def off(seen: Part, _: Part) -> Finding:
    """None comes in the two phases in which it is off."""
    counts = heard(seen)
    loud = [f"{n} messages {phase}" for phase, n in zip(PHASES[::2], counts[::2], strict=False) if n]
    return Finding(len(counts) > 2 and not loud, "no message while it is off", loud[0] if loud else "silence")


lamp.knows(
    "always_on",
    lambda seen, _: any(heard(seen)[::2]),
    "Your lamp publishes while it is off.",
    "Keep in self.on what the last request said (False at first), and publish only if it is true.",
    certain=True,
)


EXERCISE = lamp.exercise()
