"""A node that makes one call after the other is named, however silent it is."""

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.oracle.same_as_solution import SameAsSolution, To
from tests.cases import cases

KINDS = {"i": ("sent", "/seen"), "c": ("request", "/oracle"), "a": ("response", "/oracle")}
INTERFACE = {"publisher": {"/told": "x/msg/Y"}, "subscription": {"/seen": "x/msg/Y"}}


@pytest.mark.parametrize(("events", "key"), cases(__file__, "calls_that_wait_for_one_another"))
def test_calls_that_wait_for_one_another(events: str, key: str) -> None:
    noted = Event(0.0, "noted", "/told", {"step": 0, "given": "", "values": []})
    due = Event(0.0, "noted", "/told", {"step": 0, "given": "", "values": [["yes"]]})
    graph = Event(0.0, "interface", "graph", {"nodes": ["/n"], **INTERFACE})
    seen = [Event(1.0, *KINDS[letter], {"fields": {}}) for letter in events]
    exercise = SameAsSolution(
        "a.b",
        "A",
        "B",
        gives=lambda random: [To("/seen", random.random(), answered=2.5)],
        tells={"/told": "data"},
        serves={"/oracle": lambda _: {"success": True}},
    ).exercise()
    reference = Reference("a.b", INTERFACE, [Part("drawing 0", {}, [due])])
    evidence = Evidence([Part("drawing 0", {}, [graph, *seen, noted])], reference)
    assert next(one.key for one in exercise.mistakes if one.recognize(evidence)) == key
