"""The dimmer: a service of the chapter's own type sets what a publisher says, as far as it is possible."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Finding
from autograder.kit.recipes.own_scenario import Met, OwnScenario, once_met
from autograder.kit.rules import StateRule

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

POSSIBLE, TOO_MUCH = 40, 140
PATIENCE, ENOUGH = 3.0, 3
"""Seconds of the subject's time in which so many messages must have come after each call."""


def dimming(met: Met) -> bool:
    """Ask for a level that is possible, then for one that is not; listen each time."""
    return all(goes_on(met, percent) for percent in (POSSIBLE, TOO_MUCH))


def goes_on(met: Met, percent: int) -> bool:
    """Ask for a level; whether it answers and publishes."""
    (caller,) = met.callers
    caller.ask({"percent": percent})
    enough = met.heard + ENOUGH
    answered = caller.await_answers(PATIENCE)
    met.bench.run_time(PATIENCE, until=lambda: met.heard >= enough)
    return answered and met.heard >= enough


dimmer = Draft(
    "lab_2_1.dimmer",
    "Lab 2.1 · The dimmer",
    "Publish the level that the service set_level has set.",
    subject := OwnScenario(once_met(dimming), "publisher", "service"),
)
dimmer.asks("topic", 2, "Publishes on the right topic and type", subject.has("publisher"))


@dimmer.criterion("answers", 3, "Accepts what is possible, and nothing else")
def answers(seen: Part, _: Part) -> Finding:
    """The first call is accepted, the second is not."""
    told = [event.data["fields"]["accepted"] for event in seen.of("answered")]
    return Finding(told == [True, False], "True, then False", ", ".join(map(str, told)) or "no answer")


level = StateRule(lambda asked: POSSIBLE if asked else 0, given="asked")
dimmer.criterion("level", 5, "Publishes the level that was accepted")(level.when(bool))
dimmer.knows(
    "level_unlimited",
    level.taken_for(lambda asked: asked[-1].value["percent"] if asked else 0),
    f"Your dimmer publishes the level {TOO_MUCH}.",
    "Set self.level only if the percent of the request is between 0 and 100.",
    certain=True,
)
EXERCISE = dimmer.exercise()
