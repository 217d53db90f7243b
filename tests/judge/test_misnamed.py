"""A wrong name costs one criterion, and the others are judged under the name that the subject has chosen."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import pytest

from autograder import exercises
from autograder.appeals.replaying import replay
from autograder.authoring.answer_bank import answers
from autograder.judge import evidence_files
from autograder.judge.command_check import check_and_keep
from autograder.judge.timeline.verdict_timeline import moments
from autograder.judge.verdicts.deciding import decide, misnamed
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.verdict import CriterionResult, State, Verdict
from tests.cases import cases, named_cases
from tests.measure.evidence import kept, record_of

if TYPE_CHECKING:
    from pathlib import Path


STRING, OTHER = "std_msgs/msg/String", "std_msgs/msg/Int32"
FAILED = Verdict(
    "an.exercise",
    "An exercise",
    State.FAILED,
    2.0,
    10.0,
    (
        CriterionResult("spins", "Spins", 2, True, "", ""),
        CriterionResult("topic", "Topic", 2, False, "", ""),
        CriterionResult("text", "Text", 6, False, "", ""),
    ),
)


@pytest.mark.parametrize(
    ("asked", "runs", "real"), named_cases(__file__, "a_name_is_wrong_if_exactly_one_endpoint_can_be_meant")
)
def test_a_name_is_wrong_if_exactly_one_endpoint_can_be_meant(
    asked: dict[str, str], runs: list[dict[str, str]], real: str
) -> None:
    parts = [
        Part(str(i), {}, [Event(0.1, "interface", "graph", {"publisher": run})]) for i, run in enumerate(runs)
    ]
    found = misnamed(Evidence(parts, Reference("an.exercise", {"publisher": asked})), FAILED)
    assert [facts["real"] for facts in found.values()] == ([real] if real else [])
    assert {facts["costs"] for facts in found.values()} <= {"topic"}, "the first that failed"


TALKER = cases(__file__, "TALKER")
THREE = cases(__file__, "THREE")


def checked(tmp_path: Path, exercise: str, program: str) -> tuple[Verdict, Evidence]:
    file = tmp_path / "program.py"
    file.write_text(program)
    verdict, packed = check_and_keep(exercise, [sys.executable, str(file)], seed="a seed")
    return verdict, evidence_files.evidence_of(
        evidence_files.unpack(packed), evidence_files.load_reference(exercise)
    )


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize(
    ("exercise", "program", "score", "lost", "diagnosis"),
    [
        ("lab_1_2.talker", TALKER.format(topic="chater", period=0.5), 8, {"topic"}, "topic_name"),
        ("lab_1_2.talker", TALKER.format(topic="chater", period=2.0), 5, {"topic", "rate"}, None),
        ("exercise_1_2.three_ints", THREE, 8, {"calls"}, "service_name"),
    ],
)
def test_the_other_criteria_are_judged_under_the_subjects_name(
    tmp_path: Path, exercise: str, program: str, score: float, lost: set[str], diagnosis: str | None
) -> None:
    verdict, evidence = checked(tmp_path, exercise, program)
    assert {one.name for one in verdict.criteria if not one.passed} == lost
    assert verdict.score == score
    assert verdict.diagnosis
    assert diagnosis in (verdict.diagnosis.key, None)
    again: Any = decide(exercises.get(exercise), evidence, "a seed")
    assert (again.score, again.criteria) == (verdict.score, verdict.criteria), (
        "a verdict follows from the evidence"
    )


def test_the_timeline_has_the_subjects_name() -> None:
    events = [
        Event(0.0, "misnamed", "/chatter", {"real": "/chater", "costs": "topic"}),
        Event(0.1, "message", "/chatter", {"fields": {"data": "Hello"}}),
    ]
    evidence = Evidence([Part("talking", {}, events)], Reference("an.exercise", {}))
    assert [moment.lane for moment in moments(evidence)] == ["/chater"]


def test_a_robot_that_hears_nothing_has_only_a_supposed_path() -> None:
    name = "00_nervous_system.first_move"
    evidence = kept(name)
    ways = {one.name: replay(record_of(one, evidence.get(one.name)).seen).now.ways for one in answers([name])}
    assert any(ways.values())
    assert {answer for answer, driven in ways.items() if any(way.supposed for way in driven)} == {
        f"{name}/wrong/topic_name.py"
    }
