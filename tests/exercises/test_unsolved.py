"""A subject that does nothing earns nothing, whatever the exercise."""

from __future__ import annotations

from dataclasses import replace

import pytest

from autograder import exercises
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part
from autograder.kit.mistakes.unfinished import NOTHING_THERE
from autograder.kit.output.workspace_reports import WorkspaceReport, workspace_report_line


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
@pytest.mark.parametrize("nodes", [[], ["/a_node"]], ids=["nothing", "a bare node"])
def test_doing_nothing_earns_nothing(exercise_id: str, nodes: list[str]) -> None:
    stored = evidence_files.load_reference(exercise_id)
    survey = Event(0.5, "interface", "graph", {"nodes": nodes})
    returned = Event(0.6, "subject", "returned", {"value": None})
    parts = [Part(part.name, part.inputs, [survey, returned]) for part in stored.parts]
    evidence = Evidence(parts, stored)
    passed = [c.name for c in exercises.get(exercise_id).criteria if c.judge(evidence).passed]
    # Lab 1.1 asks for a bare node: to have one is a part of its answer.
    assert passed == (["node"] if nodes and exercise_id == "lab_1_1.hello" else [])


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_of_a_subject_that_does_nothing_the_card_lists_what_is_asked(exercise_id: str) -> None:
    stored, exercise = evidence_files.load_reference(exercise_id), exercises.get(exercise_id)
    returned = Event(0.6, "subject", "returned", {"value": None})
    silent = Evidence([Part(part.name, part.inputs, [returned]) for part in stored.parts], stored)
    verdict = deciding.judge(exercise, silent, "")
    assert verdict.nothing_seen
    assert {one.name: one.counts for one in verdict.criteria if one.counts}.items() <= exercise.counts.items()
    said = Event(0.5, "log", "node", {"text": "Here I am"})
    loud = replace(silent, parts=[replace(part, events=[said, returned]) for part in silent.parts])
    assert not deciding.judge(exercise, loud, "").nothing_seen


def test_of_a_launch_file_that_returns_nothing_the_card_lists_what_is_asked() -> None:
    stored = evidence_files.load_reference("exercise_1_1.remap")
    words = (
        " - Error: 'generate_launch_description()' in 'remap.launch.py' must return a LaunchDescription, not "
    )
    for returned, is_unwritten in (("None", True), ("[]", False)):
        lines = ("[ERROR] [launch]: Caught exception in launch", f"{words}{returned}")
        said = [Event(0.5, "output", "stderr", {"text": line}) for line in lines]
        evidence = Evidence([Part(part.name, part.inputs, said) for part in stored.parts], stored)
        verdict = deciding.judge(exercises.get("exercise_1_1.remap"), evidence, "")
        assert verdict.nothing_seen is is_unwritten


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_an_exercise_is_worth_ten_points_and_a_ticket_of_a_bug_hunt_five(exercise_id: str) -> None:
    exercise = exercises.get(exercise_id)
    if not exercise.hides_causes:
        assert exercise.points == 10
    elif not exercise_id.endswith("_why"):
        assert exercise.points + exercises.get(f"{exercise_id}_why").points == 5


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_each_criterion_and_mistake_can_look_at_any_evidence(exercise_id: str) -> None:
    exercise = exercises.get(exercise_id)
    evidence = Evidence([], evidence_files.load_reference(exercise_id))
    for criterion in exercise.criteria:
        assert not criterion.judge(evidence).passed
    for mistake in exercise.mistakes:
        mistake.recognize(evidence)


@pytest.mark.parametrize(
    "exercise_id", ["exercise_1_2.three_ints", "exercise_1_3.cancel", "lab_1_3.client", "lab_1_4.client"]
)
@pytest.mark.parametrize("seen", [True, False], ids=["its client was seen", "it was gone too soon"])
def test_a_function_that_comes_back_with_nothing_is_not_written_yet(exercise_id: str, seen: bool) -> None:
    stored = evidence_files.load_reference(exercise_id)
    survey = Event(0.5, "interface", "graph", {"nodes": ["/client"], **stored.interface} if seen else {})
    returned = Event(0.6, "subject", "returned", {"value": None})
    parts = [Part(part.name, part.inputs, [survey, returned]) for part in stored.parts]
    diagnosis, _ = deciding.diagnose(exercises.get(exercise_id), Evidence(parts, stored))
    asked_nothing = {"not_written", "no_call", "one_call_only"} if seen else {"not_written"}
    assert diagnosis.key in asked_nothing


@pytest.mark.parametrize(
    "exercise_id",
    ["exercise_1_2.three_ints", "inspecting_topics.mismatch", "lab_1_3.client", "lab_1_4.client"],
)
@pytest.mark.parametrize("seen", [True, False], ids=["its client was seen", "it was gone too soon"])
def test_a_function_as_it_was_handed_out_is_not_written_yet(exercise_id: str, seen: bool) -> None:
    stored = evidence_files.load_reference(exercise_id)
    started = Event(0.0, "subject", "started", {"accepted": ["patience_sec"]})
    survey = Event(0.005, "interface", "graph", {"nodes": ["/client"], **stored.interface} if seen else {})
    returned = Event(0.01, "subject", "returned", {"value": None})
    parts = [
        Part(part.name, {"patience_sec": 2.5, **part.inputs}, [started, survey, returned])
        for part in stored.parts
    ]
    diagnosis, _ = deciding.diagnose(exercises.get(exercise_id), Evidence(parts, stored))
    assert diagnosis.key == "not_written"
    assert "TODO" in diagnosis.next_step


@pytest.mark.parametrize(
    ("exercise_id", "client", "other"),
    [("lab_1_2.talker", False, True), ("lab_1_3.client", True, False), ("lab_1_3.programs", True, True)],
)
def test_a_program_that_ends_at_once_is_told_what_belongs_into_its_main(
    exercise_id: str, client: bool, other: bool
) -> None:
    stored = evidence_files.load_reference(exercise_id)
    exited = Event(0.4, "subject", "exited", {"code": 0})
    evidence = Evidence([Part(part.name, part.inputs, [exited]) for part in stored.parts], stored)
    advice = next(filter(None, (m.recognize(evidence) for m in NOTHING_THERE)))
    assert "without a node" in advice.text
    assert ("main() of a client" in advice.next_step, "make your node" in advice.next_step) == (client, other)
    assert "__name__" in advice.next_step


def test_of_a_built_program_nothing_is_said_of_the_last_lines_of_its_file() -> None:
    stored = evidence_files.load_reference("lab_1_2.talker")
    built = Event(
        0.1, "output", "stdout", {"text": workspace_report_line(WorkspaceReport("built", built=True))}
    )
    exited = Event(0.4, "subject", "exited", {"code": 0})
    advice = next(
        filter(
            None, (m.recognize(Evidence([Part("it", {}, [built, exited])], stored)) for m in NOTHING_THERE)
        )
    )
    assert "its main() makes no node" in advice.text
    assert "__name__" not in advice.next_step
