"""Who ends before it has met its server, told from who never asks: no ROS is started."""

from __future__ import annotations

import pytest

from autograder import exercises
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.giving_up import PATIENCES, broken_patience, gave_up, objection, remark
from tests.cases import cases, named_cases

ASKED = Event(0.0, "request", "/add_two_ints", {"fields": {"a": 1, "b": 2}})
ANSWERED = Event(0.0, "response", "/add_two_ints", {"fields": {"sum": 3}})
ENDED = Event(0.0, "subject", "exited", {"code": 1})
SEEN = Event(
    0.0,
    "interface",
    "graph",
    {"nodes": ["/client"], "client": {"/add_two_ints": "my_robot_interfaces/srv/AddTwoInts"}},
)


Lines = tuple[tuple[float, str], ...] | str
"""What a program says and when, or its name in LINES."""


def run(text: str, numbers: list[int], *, asked: bool = False) -> Part:
    said = Event(0.0, "output", "stderr", {"text": text})
    return Part("", {"numbers": numbers}, [SEEN, *([ASKED, ANSWERED] if asked else []), said, ENDED])


def has_asked(part: Part) -> bool:
    return bool(part.of("request"))


@pytest.mark.parametrize(
    ("served", "absent", "expected"),
    named_cases(__file__, "it_says_the_same_where_the_server_is_as_where_it_is_not"),
)
def test_it_says_the_same_where_the_server_is_as_where_it_is_not(
    served: list[str], absent: str, expected: bool
) -> None:
    parts = [run(text, numbers) for text, numbers in zip(served, ([1, 2], [10, 12]), strict=True)]
    assert gave_up(parts, run(absent, [7, 8]), has_asked) is expected


def test_a_sum_that_happens_to_be_an_own_number_is_not_what_it_says_of_a_missing_server() -> None:
    parts = [run("the sum is 18614", [18614, 0]), run("the sum is 22", [10, 12])]
    assert not gave_up(parts, run("the sum is 42953", [42953, 0]), has_asked)


def test_a_number_that_is_an_input_by_chance_is_the_same_number_all_the_same() -> None:
    # "3 s" is what the program says in each run; in two of them 3 is a number that it was given, too.
    parts = [run("not available within 3 s", [1, 2]), run("not available within 3 s", [3, 12])]
    assert gave_up(parts, run("not available within 3 s", [3, 8]), has_asked)


def test_it_asked_once_it_had_met_the_server() -> None:
    late, usual = run("nobody", [1, 2]), run("3", [1, 2], asked=True)
    assert gave_up([late, usual], run("something else", [1, 2]), has_asked)
    assert not gave_up([usual, usual], run("nobody", [1, 2]), has_asked)


@pytest.mark.parametrize("exercise_id", ["exercise_1_2.three_ints", "lab_1_3.client"])
@pytest.mark.parametrize("met_in", [[], [1], [1, 2], [2]])
def test_a_client_that_looks_once_is_told_so_whenever_it_met_the_service(
    exercise_id: str, met_in: list[int]
) -> None:
    stored = evidence_files.load_reference(exercise_id)
    parts = []
    # The recorded order of the runs is a drawn one, too.
    in_order = sorted(stored.parts, key=lambda part: part.name == "there is no service")
    for number, part in enumerate(in_order):
        seen = run("not available", part.inputs.get("numbers", [1, 2, 3]))
        events = [SEEN, *part.events, ENDED] if number in met_in else seen.events
        parts.append(Part(part.name, {"numbers": part.inputs.get("numbers", [1, 2, 3])}, events))
    diagnosis, _ = deciding.diagnose(exercises.get(exercise_id), Evidence(parts, stored))
    assert diagnosis.key == "gave_up_too_early"


PATIENT = Event(0.0, "subject", "started", {"accepted": ["patience_sec"]})
GREETS = Event(0.0, "output", "stdout", {"text": "I ask for the sum."})
RETURNED = Event(0.01, "subject", "returned", {"value": "None"})


@pytest.mark.parametrize("exercise_id", ["exercise_1_2.three_ints", "lab_1_3.client", "lab_1_4.client"])
@pytest.mark.parametrize(
    ("events", "key"),
    [
        pytest.param([GREETS, RETURNED], "nothing_on_the_graph", id="has no node, or one that is gone"),
        pytest.param([PATIENT, GREETS, RETURNED], "nothing_on_the_graph", id="is told how long to wait"),
        pytest.param([SEEN, GREETS, RETURNED], "gave_up_too_early", id="has a node"),
        pytest.param(
            [GREETS, Event(0.0, "looked", "graph"), RETURNED], "gave_up_too_early", id="waits for a moment"
        ),
    ],
)
def test_of_a_function_that_was_not_seen_to_look_for_anybody_nobody_says_that_it_gave_up(
    exercise_id: str, events: list[Event], key: str
) -> None:
    stored = evidence_files.load_reference(exercise_id)
    inputs = {"numbers": [1, 2, 3], "patience_sec": 6.6}
    parts = [Part(part.name, inputs, events) for part in stored.parts]
    diagnosis, _ = deciding.diagnose(exercises.get(exercise_id), Evidence(parts, stored))
    assert diagnosis.key == key


def _waits(
    *lines: tuple[float, str],
    told: float | None = None,
    ends: float | None = None,
    looks_at: float | None = None,
) -> Part:
    """A run without a server: what was said when, how long it was told to wait, when it ended, when it was seen."""
    events = [Event(0.0, "subject", "started", {"accepted": ["patience_sec"] if told else []})]
    if looks_at is not None:
        surveys: list[dict[str, dict[str, str]]] = [
            {"client": {}},
            {"client": {"/add_two_ints": "AddTwoInts"}},
        ]
        events += [Event(looks_at, "interface", "", survey) for survey in surveys]
    events += [Event(t, "output", "stdout", {"text": text}) for t, text in lines]
    events += [Event(ends, "subject", "returned", {"value": None})] if ends is not None else []
    return Part("", {"numbers": [1, 2], "patience_sec": told or 1.5}, events)


LINES = cases(__file__, "LINES")
EACH_SECOND = LINES["each second"]
LINES["at once"] = tuple((0.1 + t / 1000, "waiting") for t in range(200))


@pytest.mark.parametrize(
    ("lines", "how", "expected"), named_cases(__file__, "how_a_client_takes_it_that_nobody_serves")
)
def test_how_a_client_takes_it_that_nobody_serves(lines: Lines, how: dict[str, float], expected: str) -> None:
    assert objection(_waits(*LINES.get(lines, lines), **how)) == expected


@pytest.mark.parametrize("exercise_id", ["exercise_1_2.three_ints", "lab_1_3.client", "lab_1_4.client"])
@pytest.mark.parametrize("is_client", [True, False])
def test_words_about_waiting_bring_a_point_only_to_what_was_a_client_of_something(
    exercise_id: str, is_client: bool
) -> None:
    stored = evidence_files.load_reference(exercise_id)
    absent = next(part.name for part in stored.parts if part.name.startswith("there is no"))
    role = "action_client" if exercise_id == "lab_1_4.client" else "client"
    of_another_type = {"nodes": ["/client"], role: {stored.only(role)[0]: "std_srvs/srv/Trigger"}}
    on_graph = [Event(0.1, "interface", "graph", of_another_type)] if is_client else []
    parts = [
        Part(
            part.name,
            part.inputs,
            [*on_graph, *(_waits(*EACH_SECOND).events if part.name == absent else [ENDED])],
        )
        for part in stored.parts
    ]
    limit = next(one for one in exercises.get(exercise_id).criteria if one.name == "limit")
    assert limit.judge(Evidence(parts, stored)).passed is is_client


@pytest.mark.parametrize(
    ("lines", "how", "expected"),
    named_cases(__file__, "what_a_client_says_where_its_server_is_there_too_tells_of_no_trouble"),
)
def test_what_a_client_says_where_its_server_is_there_too_tells_of_no_trouble(
    lines: Lines, how: dict[str, float], expected: str
) -> None:
    usual = _waits(
        (0.1, "asking for 1 + 2"),
        (0.1, "Not available?"),
        (0.5, "servers found: 7"),
        (0.6, "the sum is 3"),
        ends=0.7,
    )
    assert objection(_waits(*LINES.get(lines, lines), **how), [usual]) == expected


@pytest.mark.parametrize(
    ("value", "instead"),
    [("0", "0"), ("'none'", "'none'"), ("'not available'", ""), (None, ""), ("[]", ""), ("False", "")],
)
def test_what_looks_like_an_answer_is_none_where_nobody_serves(value: str | None, instead: str) -> None:
    said = Event(0.1, "output", "stdout", {"text": "service not available"})
    part = Part("", {}, [said, Event(0.2, "subject", "returned", {"value": value})])
    assert objection(part) == (f"returned {instead}, as if that were the answer" if instead else "")


@pytest.mark.parametrize("seconds", [1, 2, 3, 5, 10])
@pytest.mark.parametrize("told", PATIENCES)
def test_no_usual_constant_is_taken_for_a_patience(told: float, seconds: float) -> None:
    assert broken_patience(_waits((0.1, "not available"), told=told, ends=seconds))
    assert not broken_patience(_waits((0.1, "not available"), told=told, ends=int(told)))


def test_a_wait_without_a_limit_is_worth_a_remark() -> None:
    def said_of(part: Part) -> str:
        return remark(part.name)(Evidence([part], Reference("", {})))

    assert "limit" in said_of(_waits(*EACH_SECOND))
    assert not said_of(_waits((5.0, "not available"), ends=5.0))
    assert not said_of(_waits(*EACH_SECOND, told=1.5))


def test_what_ros2_run_says_of_an_exit_code_is_no_word_of_the_program() -> None:
    assert objection(run("not available", [1, 2])) == ""
    assert objection(run("[ros2run]: Process exited with failure 3", [1, 2])) == "it was not reported"
