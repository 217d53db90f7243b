"""A repair is judged by the exercise about the right node, and its card tells no cause before the pass."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.cards.text_rendering import card_text
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part
from autograder.kit.hunts.repairs import Repairs, without_causes

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.model import Exercise

JUDGED = exercises.get("lab_1_2.talker")
REFERENCE = evidence_files.load_reference(JUDGED.id)
CAUSE = "The topic was misspelt. ROS 2 does not report that."
STRING = "std_msgs/msg/String"


def repair() -> Exercise:
    """A talker to repair."""
    return Repairs("lab_1_2.talker", "A silent talker", "Repair it.", JUDGED.id, after=[CAUSE]).exercise()


def solved(change: Callable[[Event], Event] = lambda event: event) -> Evidence:
    """The run of the solution, with its endpoints, after a change of each event."""
    graph = Event(0.0, "interface", "graph", REFERENCE.interface)
    return Evidence(
        [replace(part, events=[graph, *map(change, part.events)]) for part in REFERENCE.parts], REFERENCE
    )


def misspelt() -> Evidence:
    """The run of a talker whose topic is called /chater, and whose QoS does not fit either."""
    ends = {"nodes": ["/talker"], "publisher": {"/chater": STRING}}
    warning = "New subscription discovered, requesting incompatible QoS. Last incompatible policy: DURABILITY"
    events = [
        Event(0.1, "interface", "graph", ends),
        Event(0.2, "mismatch", "/chatter", {"policy": "durability"}),
        Event(0.3, "log", "talker", {"text": warning}),
    ]
    return Evidence([replace(part, events=events) for part in REFERENCE.parts], REFERENCE)


def test_the_card_of_a_broken_node_tells_the_symptom_and_no_cause() -> None:
    ordinary = card_text(deciding.judge(JUDGED, misspelt(), "s"))
    assert "/chater" in ordinary
    assert "topic_name" in ordinary
    verdict = deciding.judge(repair(), misspelt(), "s")
    card = card_text(verdict)
    assert "Seen: no message arrived on /chatter." in card
    assert not [
        word for word in ("/chater", "topic_name", "DURABILITY", "durability", CAUSE[:9]) if word in card
    ]
    assert verdict.diagnosis is not None
    assert (verdict.score, verdict.diagnosis.key) == (0, "topic_name")  # reports know which mistake it is


def test_the_card_of_a_repaired_node_states_the_cause() -> None:
    verdict = deciding.judge(repair(), solved(), "s")
    assert verdict.passed
    assert verdict.remarks == (CAUSE,)


def test_what_came_and_is_wrong_stands_on_the_card() -> None:
    verdict = deciding.judge(repair(), solved(_shouting), "s")
    assert verdict.diagnosis is not None
    assert "Asked for: “Says the right string”: “Hello, world! 0”" in verdict.diagnosis.text
    assert "HELLO" in verdict.diagnosis.text
    assert verdict.diagnosis.hidden
    assert not verdict.remarks


def _shouting(event: Event) -> Event:
    if event.kind != "message":
        return event
    return replace(event, data={**event.data, "fields": {"data": event.data["fields"]["data"].upper()}})


def test_what_a_subscriber_never_got_is_its_symptom() -> None:
    judged = exercises.get("lab_1_2.listener")
    reference = evidence_files.load_reference(judged.id)
    exercise = Repairs(judged.id, "A deaf listener", "Repair it.", judged.id, after=[CAUSE]).exercise()
    ends = {"nodes": ["/listener"], "subscription": {"/chater": STRING}}
    events = [Event(0.1, "interface", "graph", ends)]
    parts = [replace(part, events=events) for part in reference.parts]
    verdict = deciding.judge(exercise, Evidence(parts, reference), "s")
    assert verdict.criteria[0].seen == "no message on /chatter reached the node"
    assert "chater" not in card_text(verdict)
    met = [*events, Event(0.2, "matched", "/chatter", {"count": 1, "now": 1})]
    parts = [replace(part, events=met) for part in reference.parts]
    assert "reached" not in deciding.judge(exercise, Evidence(parts, reference), "s").criteria[0].seen


def test_a_wrong_name_is_no_symptom_even_in_a_role_that_the_exercise_does_not_ask_for() -> None:
    ends = {"publisher": {"/chater": STRING}, "subscription": {"/chater": STRING, "/chatter": STRING}}
    graph = Event(0.1, "interface", "graph", {"nodes": ["/a"], **ends})
    shown = without_causes(Evidence([Part("launching", {}, [graph])], REFERENCE)).main.events[0].data
    assert shown == {"nodes": ["/a"], "publisher": {}, "subscription": {"/chatter": STRING}}


@pytest.mark.parametrize("came", [True, False])
def test_the_symptom_of_a_node_that_ends_with_an_error_does_not_depend_on_what_came_before(
    came: bool,
) -> None:
    sent = [Event(0.1, "message", "/chatter", {"fields": {"data": "Hello, world! 0"}, "number": 1})]
    raised = Event(0.5, "subject", "raised", {"traceback": "TypeError: 'NoneType' object is not callable"})
    parts = [replace(part, events=[*sent * came, raised]) for part in REFERENCE.parts]
    verdict = deciding.judge(repair(), Evidence(parts, REFERENCE), "s")
    expected = "the program ended with an error: TypeError: 'NoneType' object is not callable"
    assert verdict.criteria[0].seen == expected


def test_a_repair_has_one_criterion_because_a_broken_node_does_half_of_the_task() -> None:
    assert [criterion.points for criterion in repair().criteria] == [4]
    half = Part(REFERENCE.parts[0].name, {}, [])
    assert deciding.judge(repair(), Evidence([half], REFERENCE), "s").score == 0
