"""A node that uses tools: what it sends is an output like others, and the judge answers in turn or by a function."""

from __future__ import annotations

import json
from math import inf
from typing import Any

import pytest

from autograder.kit.counterparts import Work
from autograder.kit.evidence import Event
from autograder.kit.oracle.outputs import Kind
from autograder.kit.oracle.steps import Text, To
from autograder.kit.oracle.tool_user import ASKED, CANCELED, DONE, TOLD, Sent, _answering


def event(kind: str, name: str, **fields: Any) -> Event:
    """Return an event with fields."""
    return Event(0.0, kind, name, {"fields": fields})


EVENTS = [
    event("message", "/said", data="error: x is nan"),
    event("request", "/lamp", data=True),
    event("response", "/lamp", success=True),
    event("goal", "/walk_to", x=1.0, y=2.0),
    event("feedback", "/walk_to", distance=1.0),
    event("request", "/door", data=False),
    Event(0.0, "cancel", "/walk_to", {"number": 1, "accepted": True}),
    Event(0.0, "cancel", "/walk_to", {"number": 1, "accepted": False}),
]


@pytest.mark.parametrize(
    ("name", "paths", "kinds", "seen"),
    [
        ("/lamp", ("data",), ASKED, [[True]]),
        ("/walk_to", ("x", "y"), DONE, [[1.0, 2.0]]),
        ("/said", ("data?",), TOLD, [[True]]),
        ("/walk_to/cancel", ("number",), CANCELED, [[1]]),
        ("/lamp", ("data",), TOLD, []),
        ("/bell", ("data",), ASKED, []),
    ],
)
def test_what_a_node_sends_is_seen(
    name: str, paths: tuple[str, ...], kinds: tuple[str, ...], seen: list[list[Any]]
) -> None:
    assert Sent(name, paths, Kind.STEPS, 0.001, kinds=kinds).values(EVENTS) == seen


def test_a_function_reads_a_part_of_a_text() -> None:
    reads = {"field": lambda fields: fields["data"].split()[1]}
    said = Sent("/said", ("field",), Kind.STEPS, 0.001, reads=reads)
    assert said.values(EVENTS) == [["x"]]
    assert said.title == "Says the right field on /said"


def test_an_input_as_json_is_shown_and_another_text_stays_as_it_is() -> None:
    call = {"tool": "walk_to", "x": float("nan")}
    assert json.loads(Text("/call", {"on": True}).value) == {"on": True}
    assert str(Text("/call", call)) == '/call: {"tool": "walk_to", "x": NaN}'
    assert Text("/call", "no JSON", answered=1.5) == ("/call", "no JSON", 0.0, 1.5)
    assert isinstance(Text("/call", "{"), To)
    assert str(To("/call", "{")) == "/call"


def test_answers_come_in_turn_and_the_last_one_again() -> None:
    answer = _answering([1, 2])
    assert [answer({}) for _ in range(4)] == [1, 2, 2, 2]
    assert _answering(lambda request: request["a"] + 1)({"a": 2}) == 3


@pytest.mark.parametrize(
    ("work", "told"),
    [(Work(takes=0.9, feedback=[{}, {}]), [0, 1, 2, 3]), (Work(takes=inf, feedback=[{}, {}]), [0, 0, 0, 0])],
)
def test_feedback_is_spread_over_the_time(work: Work, told: list[int]) -> None:
    assert [work.told_after(seconds) for seconds in (0.1, 0.3, 0.6, 0.9)] == told
    assert work.accepts
    assert not Work("rejected").accepts
