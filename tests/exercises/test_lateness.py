"""Who has waited long enough to have missed a server by a moment: no ROS is started."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING, cast
from unittest.mock import MagicMock

import pytest

from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.giving_up import (
    CLOSELY,
    LATE_AT_FIRST,
    LATENESS,
    PATIENCE,
    PATIENCES_WITHOUT_A_SERVER,
    patience_without_a_server,
)
from autograder.kit.lateness import (
    ANSWERS_LATE,
    ANSWERS_SOON,
    LONG,
    PATIENT,
    PATIENT_WITH_AN_ANSWER,
    SOON,
    TRIES,
    await_goal,
    may_be_impatient,
    meets_late_action,
    meets_present,
    missed_a_result,
    second_lateness,
    was_patient,
    was_patient_with_an_answer,
)
from autograder.kit.service_calls import HANGS_AFTER

if TYPE_CHECKING:
    from autograder.kit.bench import Bench

CALLED = Event(0.5, "called", "a server")
SERVING = Event(0.6, "serving", "/fibonacci")
SEEN = Event(0.4, "interface", "graph", {"nodes": ["/client"]})


def ended(t: float) -> Event:
    return Event(t, "subject", "exited", {"code": 1})


def said(t: float) -> Event:
    return Event(t, "output", "stderr", {"text": "there is no action server"})


@pytest.mark.parametrize(
    ("events", "expected"),
    [
        ([SEEN, said(0.4 + PATIENT), ended(0.5 + PATIENT)], True),
        ([SEEN, said(0.9), ended(0.4 + 2 * PATIENT)], False),
        ([SEEN, ended(0.4 + PATIENT)], True),
        ([SEEN, ended(0.9)], False),
        ([ended(9.0)], False),
        ([SEEN], False),
        ([SEEN, CALLED, SERVING, ended(0.4 + 2 * PATIENT)], False),
        ([SEEN, CALLED, SERVING, replace(CALLED, t=3.0), ended(0.4 + 3 * PATIENT)], True),
        ([SEEN, SERVING, replace(CALLED, t=0.7), ended(0.4 + 2 * PATIENT)], True),
    ],
)
def test_patience_is_counted_from_the_first_sign_of_life_to_the_last_word(
    events: list[Event], expected: bool
) -> None:
    assert was_patient(Part("", {}, events)) is expected


GOAL = Event(1.0, "goal", "/fibonacci", {"fields": {"order": 5}})
CANCEL = Event(3.0, "cancel", "/fibonacci", {"accepted": True})


@pytest.mark.parametrize(
    ("events", "expected"),
    [
        ([GOAL, said(1.1 + PATIENT_WITH_AN_ANSWER), ended(2.2)], True),
        ([GOAL, said(1.1), ended(1.0 + 2 * PATIENT_WITH_AN_ANSWER)], False),
        ([GOAL, CANCEL, said(3.1 + PATIENT_WITH_AN_ANSWER), ended(4.2)], True),
        ([GOAL, CANCEL, said(3.1), ended(3.2)], False),
        ([GOAL, said(1.1 + PATIENT_WITH_AN_ANSWER)], False),
        ([SEEN, said(2.0), ended(3.0)], False),
    ],
)
def test_patience_with_an_answer_is_counted_from_the_last_request(
    events: list[Event], expected: bool
) -> None:
    assert was_patient_with_an_answer(Part("", {}, events), ["goal", "cancel"]) is expected


TOLD = Event(0.0, "subject", "started", {"accepted": ["patience_sec"]})


@pytest.mark.parametrize(
    ("events", "expected"),
    [
        ([TOLD, ended(0.26)], False),
        ([TOLD, ended(0.2 + CLOSELY)], False),
        ([TOLD, ended(0.76)], True),  # a constant of three quarters of a second
        ([TOLD, ended(0.05)], True),
        ([TOLD], False),
        ([SEEN, ended(0.4 + PATIENT)], False),
        ([SEEN, said(1.4), ended(0.4 + 2 * PATIENT)], True),
        ([SEEN], False),
    ],
    ids=["its patience", "a little more", "a constant", "none", "for ever", "long", "a second", "on and on"],
)
def test_the_run_without_a_server_shows_who_waits_long_enough(events: list[Event], expected: bool) -> None:
    part = Part("", {"patience_sec": 0.22}, events)
    assert may_be_impatient(MagicMock(pace=Pace.FAST, seen=lambda: part)) is expected
    assert not may_be_impatient(MagicMock(pace=Pace.REAL_TIME, seen=lambda: part))


def test_no_constant_passes_for_a_short_patience_and_meets_a_server_that_is_a_little_late() -> None:
    shortest, longest = PATIENCES_WITHOUT_A_SERVER[Pace.FAST]
    looks = 0.25  # seconds between two looks of wait_for_service (rclpy, client.py)
    for constant in (step * looks for step in range(1, 9)):
        taken_for_patience = constant <= longest + CLOSELY
        assert not taken_for_patience or constant < LATE_AT_FIRST
    assert looks <= shortest + CLOSELY


class FakeBench:
    """A bench on which each run brings the next of some parts."""

    in_a_cell = False
    reference = Reference("lab_1_4.client", {"action_client": {"/fibonacci": "Fibonacci"}})

    def __init__(self, *runs: list[Event], pace: Pace = Pace.REAL_TIME) -> None:
        self.pace = pace
        self._runs = list(runs)
        self.met: list[tuple[float, float]] = []

    def meet(self, lateness: float, held: float) -> bool:
        self.met.append((lateness, held))
        return True

    def again(self) -> None:
        self._runs.pop(0)

    def seen(self) -> Part:
        return Part("", {}, self._runs[0])


LATE, SOONER, BOTH_SOON = (LATENESS, ANSWERS_LATE), (SOON, ANSWERS_LATE), (SOON, ANSWERS_SOON)
MISSED_SERVER = [SEEN, ended(0.4 + PATIENT)]
CLIENT_OF_IT = Event(0.4, "interface", "graph", {"action_client": {"/fibonacci": "Fibonacci"}})
MISSED_BY_A_CLIENT_OF_IT = [CLIENT_OF_IT, ended(0.4 + PATIENT)]
WAITED_LONG = [CLIENT_OF_IT, ended(0.4 + LONG)]
CLIENT_OF_ANOTHER_TYPE = [
    Event(0.4, "interface", "graph", {"action_client": {"/fibonacci": "Factorial"}}),
    ended(0.4 + PATIENT),
]
MISSED_ANSWER = [GOAL, said(1.1 + PATIENT_WITH_AN_ANSWER), ended(2.2)]
DONE = [GOAL, Event(1.2, "result_request", "/fibonacci"), ended(9.0)]


@pytest.mark.parametrize(
    ("runs", "met"),
    [
        ([DONE], [LATE]),
        ([[SEEN, ended(0.9)]], [LATE]),
        ([MISSED_SERVER, DONE], [LATE, SOONER]),
        ([MISSED_ANSWER, DONE], [LATE, BOTH_SOON]),
        ([MISSED_SERVER] * 2, [LATE, SOONER]),
        ([MISSED_BY_A_CLIENT_OF_IT] * (TRIES + 1), [LATE] + [SOONER] * TRIES),
        ([MISSED_BY_A_CLIENT_OF_IT] * 2 + [DONE], [LATE, SOONER, SOONER]),
        ([MISSED_SERVER, MISSED_ANSWER, DONE], [LATE, SOONER, BOTH_SOON]),
        ([MISSED_ANSWER] * (TRIES + 1), [LATE] + [BOTH_SOON] * TRIES),
        ([WAITED_LONG] * 2, [LATE, SOONER]),
        ([CLIENT_OF_ANOTHER_TYPE], [LATE]),
    ],
)
def test_a_patient_client_of_an_action_is_started_again_with_less_to_wait_for(
    runs: list[list[Event]], met: list[tuple[float, float]]
) -> None:
    bench = FakeBench(*runs)
    meets_late_action(cast("Bench", bench), bench.meet, ["goal"])
    assert bench.met == met


@pytest.mark.parametrize(
    ("runs", "met"),
    [([DONE], [LATE]), ([MISSED_BY_A_CLIENT_OF_IT] * 2, [LATE, SOONER]), ([MISSED_ANSWER], [LATE])],
)
def test_what_a_client_missed_in_the_fast_look_is_tried_again_in_real_time(
    runs: list[list[Event]], met: list[tuple[float, float]]
) -> None:
    bench = FakeBench(*runs, pace=Pace.FAST)
    meets_late_action(cast("Bench", bench), bench.meet, ["goal"])
    assert bench.met == met


ASKED = Event(1.2, "result_request", "/fibonacci")


@pytest.mark.parametrize(
    ("events", "missed"),
    [
        ([ASKED, ended(6.2), Event(7.0, "result", "/fibonacci")], True),
        ([ASKED, ended(6.2)], True),
        ([ASKED, Event(6.0, "result", "/fibonacci"), ended(6.2)], False),
        ([ASKED, ended(4.3)], False),  # after 3 s
        ([GOAL, ended(9.0)], False),
        ([ASKED], False),
    ],
)
def test_who_waits_for_a_result_for_more_than_four_seconds_has_missed_it(
    events: list[Event], missed: bool
) -> None:
    assert missed_a_result(Part("", {}, events)) is missed


@pytest.mark.parametrize(
    ("runs", "known", "count"),
    [
        ([DONE], True, 1),
        ([MISSED_SERVER, MISSED_SERVER, DONE], True, 3),
        ([MISSED_SERVER] * (TRIES + 1), True, TRIES + 1),
        ([MISSED_SERVER], False, 1),
        ([[SEEN, ended(0.9)], DONE], True, 2),
        ([[SEEN, ended(0.9)]] * 2, True, 2),
        ([[SEEN, ended(0.9)]], False, 1),
        ([[SEEN]], True, 1),
    ],
    ids=["met", "missed twice", "never met", "never asks", "lost", "ends at once", "unknown", "not ended"],
)
def test_who_knows_how_to_ask_and_misses_a_server_that_is_there_is_started_again(
    runs: list[list[Event]], known: bool, count: int
) -> None:
    bench = FakeBench(*runs)
    meets_present(cast("Bench", bench), lambda: bench.meet(0.0, 0.0), "goal", known=known)
    assert len(bench.met) == count


CALL = Event(0.5, "request", "/add_two_ints", {"fields": {"a": 1, "b": 2}})


@pytest.mark.parametrize(("last_word", "count"), [(0.6, 2), (1.6, 1)])
def test_no_request_of_a_client_that_waited_for_its_last_answer_was_lost_as_it_ended(
    last_word: float, count: int
) -> None:
    bench = FakeBench(*[[CALL, said(last_word), ended(2.0)]] * 2)
    meets_present(cast("Bench", bench), lambda: bench.meet(0.0, 0.0), "request", known=True, wanted=2)
    assert len(bench.met) == count


@pytest.mark.parametrize(
    ("before", "long"),
    [(None, True), ([TOLD, ended(0.26)], False), ([TOLD, ended(5.0)], True), ([TOLD], True)],
    ids=["not known", "kept", "a constant", "for ever"],
)
def test_a_function_that_kept_a_short_patience_is_not_given_a_long_one_in_the_second_look(
    before: list[Event] | None, long: bool
) -> None:
    parts = [Part("no server", {PATIENCE: 0.22}, before or [])]
    known = Evidence(parts, FakeBench.reference) if before else None
    bench = MagicMock(pace=Pace.REAL_TIME, random=Random(0), before=known)
    assert (patience_without_a_server(bench, "no server") > 1.0) == long
    bench.pace = Pace.FAST
    assert patience_without_a_server(bench, "no server") < 1.0


def test_a_client_that_falls_silent_without_a_goal_is_taken_to_hang() -> None:
    bench, server = MagicMock(), MagicMock()
    bench.wait_until.return_value = False
    await_goal(bench, server, 15.0)
    assert bench.wait_until.call_args.kwargs == {"quiet": HANGS_AFTER}
    server.await_goal.assert_called_once_with(0.0)


@pytest.mark.parametrize(("seconds", "again"), [(0.3, SOON), (0.8, LATENESS), (None, SOON)])
def test_a_client_that_may_go_by_a_clock_does_not_get_a_server_that_suits_its_clock(
    seconds: float | None, again: float
) -> None:
    seen = [Event(0.3, "interface", "graph", {}), Event(0.4, "serving", "/add_two_ints")]
    asked = [] if seconds is None else [Event(0.4 + seconds, "request", "/add_two_ints")]
    assert second_lateness([Part("a run", {}, [*seen, *asked])], "request") == again
    # The server was there before the client.
    assert second_lateness([Part("a run", {}, [*reversed(seen), *asked])], "request") == again
