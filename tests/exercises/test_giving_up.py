"""Who ends before it has met its server, told from who never asks: no ROS is started."""

from __future__ import annotations

import pytest

from autograder import exercises
from autograder.exercises.evidence import Event, Evidence, Part
from autograder.exercises.giving_up import gave_up
from autograder.judge import reference, trial

ASKED = Event(0.0, "request", "/add_two_ints", {"fields": {"a": 1, "b": 2}})
ANSWERED = Event(0.0, "response", "/add_two_ints", {"fields": {"sum": 3}})
ENDED = Event(0.0, "subject", "exited", {"code": 1})
SEEN = Event(
    0.0,
    "interface",
    "graph",
    {"nodes": ["/client"], "client": {"/add_two_ints": "my_robot_interfaces/srv/AddTwoInts"}},
)


def run(text: str, numbers: list[int], *, asked: bool = False) -> Part:
    said = Event(0.0, "output", "stderr", {"text": text})
    return Part("", {"numbers": numbers}, [SEEN, *([ASKED, ANSWERED] if asked else []), said, ENDED])


def has_asked(part: Part) -> bool:
    return bool(part.of("request"))


@pytest.mark.parametrize(
    ("served", "absent", "expected"),
    [
        pytest.param(["nobody there", "nobody there"], "nobody there", True, id="never met it"),
        pytest.param(["none for 1 2", "none for 10 12"], "none for 7 8", True, id="names its own numbers"),
        pytest.param(["the sum is 3", "the sum is 22"], "nobody there", False, id="waited and did not ask"),
        pytest.param(["the sum is 3", "the sum is 22"], "the sum is 15", False, id="neither waits nor asks"),
        pytest.param(["", ""], "", False, id="says nothing"),
    ],
)
def test_it_says_the_same_where_the_server_is_as_where_it_is_not(
    served: list[str], absent: str, expected: bool
) -> None:
    parts = [run(text, numbers) for text, numbers in zip(served, ([1, 2], [10, 12]), strict=True)]
    assert gave_up(parts, run(absent, [7, 8]), has_asked) is expected


def test_it_asked_once_it_had_met_the_server() -> None:
    late, usual = run("nobody", [1, 2]), run("3", [1, 2], asked=True)
    assert gave_up([late, usual], run("something else", [1, 2]), has_asked)
    assert not gave_up([usual, usual], run("nobody", [1, 2]), has_asked)


@pytest.mark.parametrize("exercise_id", ["exercise_1_2.three_ints", "lab_1_3.client"])
@pytest.mark.parametrize("met_in", [[], [1], [1, 2], [2]])
def test_a_client_that_looks_once_is_told_so_whenever_it_met_the_service(
    exercise_id: str, met_in: list[int]
) -> None:
    stored = reference.load(exercise_id)
    parts = []
    for number, part in enumerate(stored.parts):
        seen = run("not there", part.inputs.get("numbers", [1, 2, 3]))
        events = [SEEN, *part.events, ENDED] if number in met_in else seen.events
        parts.append(Part(part.name, {"numbers": part.inputs.get("numbers", [1, 2, 3])}, events))
    diagnosis = trial.diagnose(exercises.get(exercise_id), Evidence(parts, stored))
    assert diagnosis.key == "gave_up_too_early"
