"""What the card says of a node that makes the other end of what is asked for, or nothing of what it was given."""

from __future__ import annotations

import pytest

from autograder import exercises
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part
from tests.cases import cases


@pytest.mark.parametrize(("exercise_id", "role", "name", "advice"), cases(__file__, "the_other_end_is_named"))
def test_the_other_end_is_named(exercise_id: str, role: str, name: str, advice: str) -> None:
    stored = evidence_files.load_reference(exercise_id)
    types = next(iter(stored.interface.values()))
    survey = Event(0.5, "interface", "graph", {"nodes": ["/node"], role: {name: types[name]}})
    parts = [Part(part.name, part.inputs, [survey]) for part in stored.parts]
    told, _ = deciding.diagnose(exercises.get(exercise_id), Evidence(parts, stored))
    assert told.key == "not_written"
    assert advice in told.text


def test_a_type_that_is_returned_in_place_of_the_response_is_named() -> None:
    stored = evidence_files.load_reference("lab_1_3.server")
    raised = Event(0.5, "subject", "raised", {"traceback": "TypeError"})
    parts = [Part(part.name, part.inputs, [raised]) for part in stored.parts]
    told, _ = deciding.diagnose(exercises.get("lab_1_3.server"), Evidence(parts, stored))
    assert told.key == "callback_returned_none"
    assert "the type without parentheses" in told.text


def test_a_string_with_braces_left_in_it_lacks_its_f() -> None:
    stored = evidence_files.load_reference("lab_1_2.listener")
    survey = Event(0.1, "interface", "graph", {"nodes": ["/node"], **stored.interface})
    sent = Event(0.5, "sent", "/chatter", {"fields": {"data": "amber birch 1"}})
    said = Event(0.6, "log", "node", {"text": "I heard: {message.data}"})
    parts = [Part(part.name, part.inputs, [survey, sent, said]) for part in stored.parts]
    told, _ = deciding.diagnose(exercises.get("lab_1_2.listener"), Evidence(parts, stored))
    assert "with an f before the quotation mark" in told.next_step
