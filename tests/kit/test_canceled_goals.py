"""Which runs a client that cancels its goal gets, and what is not waited for: no ROS is started."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING, Any, cast
from unittest.mock import MagicMock

import pytest

from autograder.judge import evidence_files
from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part
from autograder.kit.giving_up import LATE_AT_FIRST, LATENESS
from autograder.kit.goal_reports import REFUSED
from autograder.kit.lateness import SOON
from autograder.kit.oracle import canceled_goals as cancel
from autograder.kit.oracle.cancel_requests import AGREED, CANCEL_REFUSED, HONORED
from autograder.kit.oracle.canceled_goals import CancelsGoal
from autograder.kit.recipes.one_goal import END_LIMIT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.counterparts import ActionCounterpart

REFERENCE = evidence_files.load_reference("exercise_1_3.cancel")
ACTION = "/fibonacci"
FEEDBACK_EVERY = 0.2
EARLIEST, LATEST, MOST = 3, 5, 19
RECIPE = CancelsGoal(
    (EARLIEST, LATEST), lambda count: {"partial_sequence": [count]}, lambda _: {"sequence": []}
)


def run(
    name: str,
    *,
    count: int = 3,
    later: float = 0.01,
    pause: float = 0.0,
    cancels: int = 1,
    says: str = "canceled",
    ends: bool = True,
) -> Part:
    """A run in which a client asks to cancel after some messages."""
    beginning = [Event(1.0, "goal", ACTION, {"fields": {"order": 20}}), Event(1.0, "goal_answered", ACTION)]
    sent = [
        Event(1.0 + pause + FEEDBACK_EVERY * number, "feedback", ACTION) for number in range(1, count + 1)
    ]
    asked = [Event(sent[-1].t + later, "cancel", ACTION, {"accepted": True})] * cancels
    asked += [Event(4.0, "result_request", ACTION)]
    result = [Event(5.0, "result", ACTION, {"status": "canceled", "fields": {"sequence": [0, 1]}})]
    said = [Event(5.1, "output", "stdout", {"text": says})] if says else []
    ending = [Event(5.2, "subject", "exited", {"code": 0})] if ends else []
    return Part(name, {}, [*beginning, *sent, *asked, *result, *said, *ending])


def fast_look(*parts: Part) -> Evidence:
    """The evidence of a fast look, with right runs where no other is given."""
    usual = (run(HONORED), run(CANCEL_REFUSED, pause=cancel.PAUSE), run(AGREED))
    given = {part.name: part for part in parts}
    return Evidence([given.get(part.name, part) for part in usual], REFERENCE)


def runs_made(first: Part, *, before: Evidence | None = None, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The runs that a look makes of a client whose first run is given."""
    made: list[str] = []

    def serve(_: Any, name: str, *__: Any, **___: Any) -> None:
        made.append(name)

    monkeypatch.setattr(RECIPE, "_serve", serve)
    monkeypatch.setattr(cancel, "refuse", lambda *_, **__: made.append(REFUSED))
    bench = MagicMock(pace=Pace.REAL_TIME if before else Pace.FAST, before=before, seen=lambda: first)
    bench.random = Random(0)
    bench.reference = REFERENCE
    RECIPE.scenario(bench)
    return list(dict.fromkeys(made))


def answers_no_more(part: Part) -> Part:
    """The same run of a client that answers nothing in the end."""
    return replace(part, events=[*part.events, Event(9.0, "unanswered", "/client")])


ALL = [HONORED, CANCEL_REFUSED, AGREED, REFUSED]
REJECTED = Part(
    REFUSED,
    {},
    [
        Event(1.0, "goal", ACTION, {"fields": {"order": 20}}),
        Event(1.0, "goal_answered", ACTION),
        Event(1.1, "output", "stdout", {"text": "rejected"}),
        Event(1.2, "subject", "exited", {"code": 1}),
    ],
)


@pytest.mark.parametrize(
    ("first", "made"),
    [
        (run(HONORED), ALL),
        # It has lost the points for all ends of goals.
        (run(HONORED, says="it is over"), [HONORED, CANCEL_REFUSED, REFUSED]),
        (run(HONORED, cancels=0), [HONORED, REFUSED]),
        (answers_no_more(run(HONORED, cancels=0)), [HONORED]),
    ],
    ids=["right", "says no end", "never asks", "answers no more"],
)
def test_the_fast_look_leaves_out_runs_that_can_change_no_points(
    first: Part, made: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert runs_made(first, monkeypatch=monkeypatch) == made


@pytest.mark.parametrize(
    ("parts", "first", "made"),
    [
        ([REJECTED], run(HONORED), []),
        ([], run(HONORED), [REFUSED]),
        ([run(HONORED, says="it is over", ends=False)], run(HONORED), [HONORED, REFUSED]),
        # A clock may have made it ask.
        ([run(HONORED, later=0.15)], run(HONORED), ALL),
        (
            [run(HONORED, later=0.15), run(CANCEL_REFUSED, pause=cancel.PAUSE, later=0.15)],
            run(HONORED),
            [HONORED, CANCEL_REFUSED, REFUSED],
        ),
        # After a pause it asks at the moment at which it asked without one.
        ([run(CANCEL_REFUSED)], run(HONORED), ALL),
        ([run(CANCEL_REFUSED, pause=cancel.PAUSE, cancels=2)], run(HONORED), [CANCEL_REFUSED, REFUSED]),
        # It is too late again, whatever the other runs show.
        ([run(HONORED, count=6), REJECTED], run(HONORED, count=6), [HONORED]),
        ([run(HONORED, count=6), REJECTED], run(HONORED), [HONORED, CANCEL_REFUSED, AGREED]),
    ],
    ids=[
        "right",
        "rejected",
        "hangs",
        "clock",
        "clocks",
        "not by feedback",
        "twice",
        "too late",
        "too late once",
    ],
)
def test_the_look_in_real_time_repeats_what_time_may_have_decided(
    parts: Sequence[Part], first: Part, made: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    looked = fast_look(*parts)
    before = Evidence([*looked.parts, *(part for part in parts if part.name == REFUSED)], REFERENCE)
    assert runs_made(first, before=before, monkeypatch=monkeypatch) == made


@pytest.mark.parametrize(
    ("before", "late"),
    [
        (None, LATE_AT_FIRST),
        (fast_look(run(HONORED, later=0.15)), SOON),
        (fast_look(Part(HONORED)), LATENESS),
    ],
    ids=["first look", "waited", "never sent a goal"],
)
def test_a_client_that_has_waited_for_a_late_server_is_not_kept_waiting_again(
    before: Evidence | None, late: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    came: list[float] = []
    monkeypatch.setattr(RECIPE, "_serve", lambda *_, late, **__: came.append(late))
    bench = MagicMock(pace=Pace.REAL_TIME if before else Pace.FAST, before=before, reference=REFERENCE)
    bench.random = Random(0)
    bench.seen = lambda: run(HONORED)
    RECIPE._run(bench, HONORED)
    assert came == [late]


def window(gap: float, first: float = cancel.FIRST_AFTER) -> tuple[float, float]:
    """The seconds after the goal at which the third message comes, and the sixth."""
    began = first + cancel.LATE_GAP  # the status comes before the second message
    return began + (EARLIEST - 1) * gap, began + LATEST * gap


def test_no_fixed_time_after_anything_is_right_at_both_paces() -> None:
    _, quick_ends = window(max(cancel.QUICK))
    slow_begins, _ = window(min(cancel.SLOW))
    # Counted from the client's start, the goal of the first run comes later than that of the second.
    assert quick_ends + LATENESS < slow_begins


def test_the_paces_are_drawn_and_differ_between_the_two_runs_that_are_judged(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(RECIPE, "_serve", lambda *_, **__: None)
    gaps: dict[str, set[float]] = {}
    for seed in range(5):
        bench = MagicMock(pace=Pace.FAST, before=None, reference=REFERENCE, random=Random(seed))
        bench.seen = lambda: run(HONORED)
        for name, first in ((HONORED, None), (CANCEL_REFUSED, run(HONORED))):
            RECIPE._run(bench, name, first)
            gaps.setdefault(name, set()).add(bench.part.call_args.kwargs["gap"])
    assert [len(drawn) for drawn in gaps.values()] == [5, 5]
    assert max(gaps[HONORED]) < min(gaps[CANCEL_REFUSED])


@pytest.mark.parametrize(
    ("in_a_cell", "asks", "prepared"), [(True, True, True), (True, False, False), (False, True, False)]
)
def test_the_server_is_there_before_a_function_that_is_known_to_ask_for_its_result(
    in_a_cell: bool, asks: bool, prepared: bool
) -> None:
    calls = [name for name, *_ in _served(run(HONORED) if asks else _never_asks(), in_a_cell).mock_calls]
    assert (calls.index("serve_action") < calls.index("start")) == prepared


@pytest.mark.parametrize(
    ("asked", "cancels", "waits"),
    [(None, True, True), (True, True, True), (False, True, False), (True, False, False)],
)
def test_only_who_cancels_and_is_not_known_to_leave_its_result_is_waited_for(
    asked: bool | None, cancels: bool, waits: bool
) -> None:
    """What a client asked in the first run is not known yet in that run."""
    first = None if asked is None else run(HONORED) if asked else _never_asks()
    bench = _served(first, cancels=cancels)
    usual = END_LIMIT[Pace.FAST]
    (waited,) = bench.serve_action.return_value.await_result_request.call_args.args
    assert (waited == usual) if waits else (waited < usual)


@pytest.mark.parametrize("asks", [True, False])
def test_a_cancel_is_refused_only_if_the_client_asks_how_its_goal_ended(asks: bool) -> None:
    bench = _served(run(HONORED) if asks else _never_asks(), name=CANCEL_REFUSED)
    assert bench.serve_action.call_args.kwargs["accept_cancel"] is not asks


@pytest.mark.parametrize("says", ["canceled", "it is over"])
def test_a_client_that_did_not_say_how_its_first_goal_ended_need_not_say_so_again(says: str) -> None:
    bench = _served(run(HONORED, says=says))
    hangs = [call.args[1] for call in bench.wait_until.mock_calls if len(call.args) > 1]
    assert (END_LIMIT[Pace.FAST] in hangs) == (says == "canceled")


def _never_asks() -> Part:
    usual = run(HONORED)
    return Part(HONORED, {}, [event for event in usual.events if event.kind != "result_request"])


def _served(
    first: Part | None, in_a_cell: bool = False, name: str = AGREED, cancels: bool = True
) -> MagicMock:
    """A bench on which a run was served to a client that asks to cancel at once, or never."""
    bench = MagicMock(pace=Pace.FAST, in_a_cell=in_a_cell, reference=REFERENCE)
    bench.serve_action.return_value.await_cancel.return_value = cancels
    bench.seen = lambda: Part(name, {"gap": cancel.QUICK[0]}, run(name).events)
    RECIPE._serve(bench, name, first, late=0.0, held=0.0)
    return bench


class Server:
    """A server whose client never asks to cancel; it keeps how long it waited for that."""

    def __init__(self) -> None:
        self.waits: list[float] = []
        self.sent = 0

    def await_cancel(self, within: float) -> bool:
        self.waits.append(within)
        return False

    def send_feedback(self, **_: Any) -> None:
        self.sent += 1

    def say_status(self) -> None:
        pass


def test_once_the_moment_is_over_the_rest_of_the_feedback_comes_quickly() -> None:
    server = Server()
    bench = MagicMock(pace=Pace.REAL_TIME, seen=lambda: Part(HONORED, {"gap": cancel.QUICK[0]}))
    _, asked = RECIPE._until_canceled(bench, cast("ActionCounterpart", server), 0.0)
    assert not asked
    quick, last = server.waits[LATEST + 1 : -1], server.waits[-1]
    assert server.sent == MOST == LATEST + len(quick)
    assert set(quick) == {cancel.AT_ONCE}
    assert last == cancel.CLOCKS
