"""The dimmer: a service of the chapter's own type sets what a publisher says, as far as it is possible."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Bench, Finding
from autograder.kit.recipes.own_scenario import OwnScenario

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

POSSIBLE, TOO_MUCH = 40, 140
PATIENCE, ENOUGH = 3.0, 3
"""Seconds of the subject's time in which so many messages must have come after each call."""


def scenario(bench: Bench) -> None:
    """Ask for a level that is possible, then for one that is not; listen each time."""
    topic, type_name = bench.reference.only("publisher")
    service, service_type = bench.reference.only("service")
    bench.part("dimming")
    bench.listen(topic, type_name)
    caller = bench.call(service, service_type)
    bench.start()
    there = bench.await_endpoint("publisher", topic) and bench.await_endpoint("service", service)
    bench.release()
    if there and caller.await_server(PATIENCE):
        for percent in (POSSIBLE, TOO_MUCH):
            caller.ask({"percent": percent})
            answered = caller.await_answers(PATIENCE)
            enough = bench.heard(topic) + ENOUGH
            bench.run_time(PATIENCE, until=lambda enough=enough: bench.heard(topic) >= enough)  # type: ignore[misc]
            if not answered or bench.heard(topic) < enough:
                bench.note_whether_it_spins()
                break
    bench.stop()


dimmer = Draft(
    "lab_2_1.dimmer",
    "Lab 2.1 · The dimmer",
    "Publish the level that the service set_level has set.",
    subject := OwnScenario(scenario, "publisher", "service"),
)
dimmer.asks("topic", 2, "Publishes on the right topic and type", subject.is_there)


def levels(seen: Part) -> list[int]:
    """The level that was published last after each call."""
    last: list[int] = []
    for event in seen.events:
        last += [-1] * (event.kind == "answered")
        if event.kind == "message" and last:
            last[-1] = event.data["fields"]["data"]
    return last


@dimmer.criterion("answers", 3, "Accepts what is possible, and nothing else")
def answers(seen: Part, _: Part) -> Finding:
    """The first call is accepted, the second is not."""
    told = [event.data["fields"]["accepted"] for event in seen.of("answered")]
    return Finding(told == [True, False], "True, then False", ", ".join(map(str, told)) or "no answer")


@dimmer.criterion("level", 5, "Publishes the level that was accepted")
def level(seen: Part, _: Part) -> Finding:
    """After both calls it publishes the level of the first one."""
    heard = levels(seen)
    return Finding(heard == [POSSIBLE] * 2, f"{POSSIBLE} after each of the two calls", str(heard))


@dimmer.mistake(
    "level_unlimited",
    certain=True,
    says=f"Your dimmer publishes the level {TOO_MUCH}.",
    next_step="Set self.level only if the percent of the request is between 0 and 100.",
)
def level_unlimited(seen: Part, _: Part) -> bool:
    """It has taken the level that is not possible."""
    return levels(seen)[1:] == [TOO_MUCH]


EXERCISE = dimmer.exercise()
