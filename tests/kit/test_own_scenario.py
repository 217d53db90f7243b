"""A subject with several endpoints of a role: each is named when it is missing, misnamed or of another type."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.own_scenario import OwnScenario

COUNT, RESET = {"/count": "std_srvs/srv/Trigger"}, {"/reset": "std_srvs/srv/Empty"}
REFERENCE = Reference("lab.counter", {"service": COUNT | RESET}, [Part("counting")])
RECIPE = OwnScenario(lambda _: None, "service")


def seen(services: dict[str, str]) -> Evidence:
    event = Event(0.1, "interface", "graph", {"nodes": ["/counter"], "service": services})
    return Evidence([Part("counting", {}, [event])], REFERENCE)


@pytest.mark.parametrize(
    ("services", "key", "word"),
    [
        (COUNT | RESET, "", ""),
        (
            COUNT | {"/rest": "std_srvs/srv/Empty"},
            "service_name",
            "/rest, but the task asks for the service /reset.",
        ),
        (
            COUNT | {"/reset": "std_srvs/srv/Trigger"},
            "message_type",
            "On /reset your node uses the type std_srvs/srv/Trigger",
        ),
        (RESET, "not_written", "serves /count"),
        (COUNT, "not_written", "serves /reset"),
    ],
    ids=["right", "misnamed", "of another type", "first missing", "second missing"],
)
def test_each_endpoint_of_a_role_counts(services: dict[str, str], key: str, word: str) -> None:
    evidence = seen(services)
    found = [(mistake.key, advice) for mistake in RECIPE.ladder if (advice := mistake.recognize(evidence))]
    assert found[0][0] == key if key else not found
    assert not found or word in found[0][1].text
    assert RECIPE.has("service")(evidence).passed is not bool(key)


def test_a_services_callback_that_returns_nothing_is_named_in_a_notebook_too() -> None:
    raised = Event(0.5, "subject", "raised", {"traceback": "TypeError"})
    evidence = Evidence([Part("counting", {}, [raised])], REFERENCE)
    assert next(one.key for one in RECIPE.ladder if one.recognize(evidence)) == "callback_returned_none"


def test_what_is_expected_has_the_references_endpoints() -> None:
    evidence = seen(COUNT)
    assert RECIPE.expected(evidence).endpoints("service") == COUNT | RESET
    assert RECIPE.seen(evidence).endpoints("service") == COUNT
