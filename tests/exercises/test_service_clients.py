"""What a service client meets in a check, and in which order: no ROS is started."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import Any
from unittest.mock import MagicMock

import pytest
from exercise_1_2 import three_ints as exercise_1_2_three_ints
from lab_1_3 import client as lab_1_3_client

from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.lateness import ANSWERS_SOON
from autograder.kit.recipes import service_runs
from autograder.kit.recipes.service_client import NOT_RETURNED
from autograder.kit.recipes.service_runs import Run, answering, has_spoken, is_done
from autograder.kit.reported_texts import mentions
from autograder.kit.service_calls import (
    ABSENT,
    BIASED,
    CALLED,
    EXTREME,
    LATE,
    ClientSeen,
    braces_left,
    cut_short,
    gives_up_in_time,
    reports,
)
from tests.cases import cases

SEEDS = range(60)
REFERENCE = evidence_files.load_reference("lab_1_3.client")
TYPE = "my_robot_interfaces/srv/AddTwoInts"
RETURNED = Event(0.4, "subject", "returned", {"value": "-987654321"})
RAISED = Event(
    0.4, "subject", "raised", {"traceback": "AttributeError: 'Response' object has no attribute 'total'"}
)

ON_PURPOSE = Event(
    0.4,
    "subject",
    "raised",
    {
        "traceback": "Traceback (most recent call last):\n"
        '  File "client.py", line 20, in ask\n'
        "    raise RuntimeError('no answer')\n"
        "RuntimeError: no answer"
    },
)


def runs_of(
    scenario: Any, seed: int, monkeypatch: pytest.MonkeyPatch, *, waited_for: bool = False
) -> list[tuple[str, Any]]:
    """The runs of a check in their order, each with its name and what it is made of."""
    order: list[tuple[str, Any]] = []

    def called(_: Any, run: Run, *__: Any) -> bool:
        order.append((run.name, run))
        return True

    monkeypatch.setattr(service_runs, "called", called)
    monkeypatch.setattr(service_runs, "called_late", called)
    monkeypatch.setattr(service_runs, "unserved", lambda _, numbers: order.append((ABSENT, numbers)))
    bench = MagicMock(pace=Pace.FAST, random=Random(seed), seen=lambda: Part(LATE), is_waited_for=waited_for)
    scenario(bench)
    return order


@pytest.mark.parametrize(
    ("impatient", "waited_for", "lateness"),
    [(False, False, [0.65]), (True, False, [0.65, 1.5]), (False, True, [0.65]), (True, True, [1.5])],
    ids=["patient", "impatient", "patient, a student waits", "impatient, a student waits"],
)
def test_a_service_comes_as_late_as_allowed_if_nothing_shows_that_its_client_would_have_waited(
    impatient: bool, waited_for: bool, lateness: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    came: list[float] = []

    def called_late(_: Any, run: Run, calls: int, seconds: float, again: float) -> bool:
        came.append(seconds)
        return True

    monkeypatch.setattr(service_runs, "called_late", called_late)
    monkeypatch.setattr(service_runs, "called", lambda *_: True)
    monkeypatch.setattr(service_runs, "unserved", lambda *_: None)
    monkeypatch.setattr(service_runs, "may_be_impatient", lambda _: impatient)
    asked = Part(LATE, {}, [Event(0.0, "request", "/add_two_ints", {})])
    bench = MagicMock(
        pace=Pace.FAST, random=Random(0), seen=lambda: asked, before=None, is_waited_for=waited_for
    )
    service_runs.scenario(bench, [Run(LATE, (1, 2)), Run(BIASED, (1, 2))], (3, 4), calls=1)
    assert came == lateness
    assert [call.args for call in bench.again.mock_calls] == [(LATE,)] * (len(lateness) - 1)


@pytest.mark.parametrize("exercise", [exercise_1_2_three_ints, lab_1_3_client])
def test_the_run_without_a_service_comes_first_if_a_student_waits_since_it_is_the_shortest(
    exercise: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    order = runs_of(exercise.EXERCISE.scenario, SEEDS[0], monkeypatch, waited_for=True)
    assert [name for name, _ in order][:2] == [ABSENT, LATE]


@pytest.mark.parametrize("exercise", [exercise_1_2_three_ints, lab_1_3_client])
def test_nobody_can_tell_the_run_without_a_service_by_its_place_or_its_numbers(
    exercise: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    places, kinds = set(), set()
    for seed in SEEDS:
        order = runs_of(exercise.EXERCISE.scenario, seed, monkeypatch)
        assert order[0][0] == LATE
        places.add([name for name, _ in order].index(ABSENT))
        numbers = dict(order)[ABSENT]
        kinds.add("64 bits" if max(map(abs, numbers)) > 2**40 else "negative")
        # A client may repeat its numbers before it gives up: none of them may be the sum.
        assert sum(numbers) not in numbers
    assert places == {1, 2, 3}
    assert kinds == {"64 bits", "negative"}


@pytest.mark.parametrize("exercise", [exercise_1_2_three_ints, lab_1_3_client])
def test_each_check_has_a_zero_a_negative_answer_64_bits_and_an_answer_that_is_held_back(
    exercise: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    for seed in SEEDS:
        last, held = [], []
        for name, run in runs_of(exercise.EXERCISE.scenario, seed, monkeypatch):
            if name == ABSENT:
                continue
            answer = answering(run.answers)
            total, *others = run.numbers
            for number in others:
                total = answer({"a": total, "b": number})["sum"]
            last.append(total)
            held.append(run.held)
            # What a client repeats of its numbers must not be taken for a 0 that it reports.
            assert total != 0 or not mentions([str(list(run.numbers))], 0)
        assert 0 in last
        assert min(last) < -(2**61)
        assert sum(total < 0 for total in last) >= 2
        assert any(held)


@pytest.mark.parametrize(("line", "number", "expected"), cases(__file__, "a_number_is_known_among_words"))
def test_a_number_is_known_among_words(line: str, number: int, expected: bool) -> None:
    assert mentions([line], number) is expected


def seen_of(name: str, *seen: tuple[str, str, dict[str, Any]]) -> Part:
    """A part in which these events were seen, one each second."""
    events = [Event(float(t), kind, what, data) for t, (kind, what, data) in enumerate(seen)]
    return Part(name, {"numbers": [1001, 1002]}, events)


def answered(total: int) -> tuple[str, str, dict[str, Any]]:
    return "response", "/add_two_ints", {"fields": {"sum": total}}


def test_who_is_done_stays_so_while_one_more_call_is_on_its_way() -> None:
    said = ("output", "stdout", {"text": "Final sum: -4321"})
    part = seen_of(LATE, answered(0), answered(-4321), said, answered(1001))
    for until in (3, 4):
        evidence = Evidence([Part(LATE, part.inputs, part.events[:until])], Reference("e", {}))
        assert is_done(evidence, 2)
        assert has_spoken(evidence, 2)


def test_to_give_up_at_once_does_not_count_more_where_one_call_came_through_by_chance() -> None:
    gone = ("output", "stderr", {"text": "add_two_ints is not available"}), ("subject", "exited", {"code": 1})
    asked = ("request", "/add_two_ints", {"fields": {"a": 1, "b": 2}})
    evidence_files = Reference("e", {"client": {"/add_two_ints": "my_robot_interfaces/srv/AddTwoInts"}})
    unlucky = [seen_of(name, *gone) for name in (LATE, BIASED, ABSENT)]
    lucky = [unlucky[0], seen_of(BIASED, asked, answered(3)), unlucky[2]]
    patient = [seen_of(LATE, asked, answered(3)), lucky[1], unlucky[2]]
    passed = [gives_up_in_time(Evidence(parts, evidence_files)).passed for parts in (unlucky, lucky, patient)]
    assert passed == [False, False, True]


@pytest.mark.parametrize(
    ("value", "right"),
    [
        *cases(__file__, "a_function_that_returns_something_returns_the_sum_whatever_it_logs"),
        (None, False),
    ],
)
def test_a_function_that_returns_something_returns_the_sum_whatever_it_logs(
    value: str | None, right: bool
) -> None:
    said = ("output", "notebook log", {"text": "1 + 2 = -4321"})
    part = seen_of(LATE, answered(-4321), said, ("subject", "returned", {"value": value, "traceback": ""}))
    assert reports(part) is right


@pytest.mark.parametrize("value", ["'1 + 2 = -4321'", "AddTwoInts_Response(sum=-4321)"])
def test_a_function_that_returns_the_sum_among_other_words_is_told_to_return_the_number(value: str) -> None:
    parts = [
        seen_of(name, answered(-4321), ("subject", "returned", {"value": value, "traceback": ""}))
        for name in CALLED
    ]
    advice = NOT_RETURNED.recognize(Evidence(parts, Reference("x", {})))
    assert advice is not None
    assert value in advice.text


def _reported(*after: Event) -> Part:
    asked = Event(0.1, "request", "/add_two_ints", {"fields": {"a": 1, "b": 2}})
    given = Event(0.2, "response", "/add_two_ints", {"fields": {"sum": -987654321}})
    return Part(LATE, {"numbers": [1, 2]}, [asked, given, *after])


@pytest.mark.parametrize(
    ("after", "right"),
    [
        ([Event(0.3, "log", "node", {"text": "1 + 2 = -987654321"})], True),
        ([Event(0.3, "log", "node", {"text": "1 + 2 = 987654321"})], False),
        ([Event(0.3, "log", "node", {"text": "1 + 2 = 987654321"}), RETURNED], False),
        ([Event(0.3, "log", "node", {"text": "1 + 2 = -987654321 (or 987654321 without its sign)"})], True),
        ([Event(0.3, "log", "node", {"text": "1 + 2 = -987654321"}), RAISED], False),
        ([RETURNED], True),
    ],
)
def test_one_wrong_report_beside_a_right_one_is_wrong(after: list[Event], right: bool) -> None:
    assert reports(_reported(*after)) is right


@pytest.mark.parametrize(
    ("after", "key"),
    [
        ([ON_PURPOSE], "result_read_too_early"),
        ([Event(0.4, "subject", "exited", {"code": 0})], "sum_not_reported"),
    ],
)
def test_who_raises_has_not_waited_also_where_the_answer_came_before_its_end(
    after: list[Event], key: str
) -> None:
    known = Event(0.05, "interface", "graph", {"nodes": ["/n"], "client": {"/add_two_ints": TYPE}})
    part = _reported(*after)
    seen = Evidence([replace(part, events=[known, *part.events])], REFERENCE)
    found, _ = deciding.diagnose(lab_1_3_client.EXERCISE, seen)
    assert found.key == key


def _given_up(name: str, *, waited: float, answered: float) -> Part:
    """A run of a client that gives up on its answer."""
    events = [
        Event(0.1, "request", "/add_two_ints", {"fields": {"a": 1, "b": 2}}),
        Event(0.1 + answered, "response", "/add_two_ints", {"fields": {"sum": -987654321}}),
        Event(0.1 + waited, "subject", "exited", {"code": 1}),
    ]
    return Part(name, {"numbers": [1, 2]}, sorted(events, key=lambda event: event.t))


@pytest.mark.parametrize(("waited", "met"), [(1.0, True), (0.01, False)], ids=["stays", "does not stay"])
def test_it_earns_the_same_for_a_late_service_however_long_an_answer_is_held_back(
    waited: float, met: bool
) -> None:
    found = [
        lab_1_3_client.recipe.waits(
            Evidence([_given_up(name, waited=waited, answered=answered) for name in CALLED], REFERENCE)
        )
        for answered in (0.7, 1.9)
    ]
    assert [one.passed for one in found] == [met, met]


def test_right_numbers_are_not_told_as_wrong_where_the_answer_was_not_awaited() -> None:
    early = [_given_up(name, waited=0.01, answered=0.7) for name in CALLED]
    found, _ = deciding.diagnose(lab_1_3_client.EXERCISE, Evidence(early, REFERENCE))
    assert found.key == "result_read_too_early"


@pytest.mark.parametrize("lateness", [0.0, 1.5])
def test_the_service_comes_when_its_client_is_known_so_that_no_call_gets_lost(lateness: float) -> None:
    bench = MagicMock(pace=Pace.FAST)
    bench.reference.only.return_value = ("/add_two_ints", "my_robot_interfaces/srv/AddTwoInts")
    assert _meets(lateness=lateness) == [
        "start",
        "await_endpoint",
        *(["let_wait"] if lateness else []),
        "serve",
    ]


def test_the_service_is_there_before_a_client_that_is_known_to_wait_for_its_answers() -> None:
    assert _meets(prepared=True) == ["serve", "start", "await_endpoint"]


def _meets(**how: Any) -> list[str]:
    bench = MagicMock(pace=Pace.FAST)
    bench.reference.only.return_value = ("/add_two_ints", "my_robot_interfaces/srv/AddTwoInts")
    service_runs.meets_service(bench, Run(BIASED, (1, 2)), 1, **how)
    return [name for name, *_ in bench.mock_calls if name in ("start", "await_endpoint", "let_wait", "serve")]


@pytest.mark.parametrize("in_a_cell", [True, False])
@pytest.mark.parametrize("waits", [True, False])
def test_only_a_function_that_has_reported_an_answer_finds_its_service_there(
    in_a_cell: bool, waits: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found: list[bool] = []

    def meets_service(*_: Any, prepared: bool, says_more: float) -> bool:
        found.append(prepared)
        return True

    monkeypatch.setattr(service_runs, "meets_service", meets_service)
    bench = MagicMock(pace=Pace.FAST, in_a_cell=in_a_cell, seen=lambda: Part(BIASED))
    service_runs.called(bench, Run(BIASED, (1, 2)), 1, [_reported(RETURNED) if waits else Part(LATE)])
    assert found == [in_a_cell and waits]


IN_VAIN = Event(0.2, "request", "/add_two_ints", {"fields": {"a": 1, "b": 2}})


@pytest.mark.parametrize(
    ("missed", "pace", "earlier", "runs"),
    [
        (0, Pace.REAL_TIME, [], 1),
        (1, Pace.REAL_TIME, [], 2),
        (2, Pace.REAL_TIME, [], 3),
        (99, Pace.REAL_TIME, [], 4),
        (99, Pace.FAST, [], 1),
        # The points for the sum are lost in any case,
        (99, Pace.REAL_TIME, [Part(BIASED, {}, [IN_VAIN])], 2),
        # and here those for the calls, too.
        (99, Pace.REAL_TIME, [Part(BIASED)], 1),
    ],
)
def test_who_waited_long_and_missed_an_answer_is_started_again_while_that_can_save_points(
    missed: int, pace: Pace, earlier: list[Part], runs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: list[float | None] = []
    first = Part(LATE)

    def meets_service(*_: Any, held_for: float | None = None, **__: Any) -> bool:
        held.append(held_for)
        return True

    monkeypatch.setattr(service_runs, "meets_service", meets_service)
    monkeypatch.setattr(
        service_runs, "reports", lambda part: part is first or (part not in earlier and len(held) > missed)
    )
    monkeypatch.setattr(service_runs, "was_patient_with_an_answer", lambda *_: True)
    bench = MagicMock(pace=pace, random=Random(0))
    assert service_runs.called(bench, Run(EXTREME, (1, 2), held=1), 1, [first, *earlier])
    assert held == [None, *[ANSWERS_SOON] * (runs - 1)]
    assert bench.again.call_count == runs - 1


@pytest.mark.parametrize(
    ("line", "told"),
    [("the sum is {total}", True), ("{'sum': 7}", False), ("{}", False), ("the sum is 7", False)],
)
def test_braces_that_were_not_filled_in_are_told_as_a_missing_f(line: str, told: bool) -> None:
    given = Event(0.1, "response", "/add_two_ints", {"fields": {"sum": 12}})
    advice = braces_left(Part(BIASED, {}, [given, Event(0.2, "output", "stdout", {"text": line})]))
    assert (advice is not None and line in advice.text) == told


def test_a_client_that_hangs_after_its_call_is_not_said_to_have_made_none() -> None:
    asked = Event(0.1, "request", "/add_two_ints", {"fields": {"a": 19201, "b": 0}})
    hung = Evidence([Part(LATE, {"numbers": [19201, 0]}, [asked])], Reference("lab_1_3.client", {}))
    words = "one call (the service comes late), then it hung, so the other runs were left out"
    assert cut_short(ClientSeen(hung)) == words
    ended = Evidence([Part(LATE, {}, [asked, RETURNED])], Reference("lab_1_3.client", {}))
    assert cut_short(ClientSeen(ended)) == ""


@pytest.mark.parametrize(
    ("kind", "made"), [(TYPE, [LATE, BIASED, ABSENT]), ("example_interfaces/srv/AddTwoInts", [LATE, ABSENT])]
)
def test_a_client_of_another_type_is_given_the_service_once(
    kind: str, made: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    names: list[str] = []

    def called(_: Any, run: Run, *__: Any) -> bool:
        names.append(run.name)
        return True

    monkeypatch.setattr(service_runs, "called_late", lambda *_: True)
    monkeypatch.setattr(service_runs, "called", called)
    monkeypatch.setattr(service_runs, "unserved", lambda *_: names.append(ABSENT))
    seen = Part(LATE, {}, [Event(0.1, "interface", "graph", {"client": {"/add_two_ints": kind}})])
    bench = MagicMock(pace=Pace.REAL_TIME, random=Random(0), seen=lambda: seen)
    bench.reference.only.return_value = ("/add_two_ints", TYPE)
    service_runs.scenario(bench, [Run(LATE, (1, 2)), Run(BIASED, (1, 2))], (3, 4), calls=1)
    assert sorted([LATE, *names]) == sorted(made)


@pytest.mark.parametrize("silent", [True, False])
def test_nobody_waits_for_a_sum_of_a_client_that_has_kept_one_to_itself(
    silent: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    waited: list[float] = []

    def meets_service(*_: Any, says_more: float, **__: Any) -> bool:
        waited.append(says_more)
        return True

    monkeypatch.setattr(service_runs, "meets_service", meets_service)
    bench = MagicMock(pace=Pace.REAL_TIME, in_a_cell=False, seen=lambda: Part(BIASED))
    first = Part(LATE, {}, [IN_VAIN]) if silent else _reported(RETURNED)
    service_runs.called(bench, Run(BIASED, (1, 2)), 1, [first])
    more = service_runs.SAYS_MORE[Pace.REAL_TIME]
    assert waited == [service_runs.AFTERMATH if silent else more]


@pytest.mark.parametrize(
    ("second", "sure"),
    [((39_622, 0), True), ((0, 1), False), ((0, 0), False)],
    ids=["own sum", "other", "right"],
)
def test_a_sum_of_its_own_in_the_place_of_an_answer_of_0_shows_that_0_is_taken_for_no_answer(
    second: tuple[int, int], sure: bool
) -> None:
    def called(name: str, numbers: list[int], *calls: tuple[int, int, int]) -> Part:
        events = []
        for a, b, answer in calls:
            events.append(Event(1.0, "request", "/add_two_ints", {"fields": {"a": a, "b": b}}))
            events.append(Event(1.1, "response", "/add_two_ints", {"fields": {"sum": answer}}))
        said = Event(1.2, "output", "stdout", {"text": str(calls[-1][-1])})
        return Part(name, {"numbers": numbers}, [*events, said, Event(1.3, "subject", "exited", {"code": 0})])

    late = called(LATE, [39_622, 0, 0], (39_622, 0, 0), (*second, -5_000_000_000))
    biased = called(BIASED, [-1500, 2500, 3500], (-1500, 2500, -7_000_000), (-7_000_000, 3500, 0))
    reference = evidence_files.load_reference("exercise_1_2.three_ints")
    seen = Evidence([late, biased], reference)
    assert exercise_1_2_three_ints.recipe._dislikes_zero(seen) is sure
