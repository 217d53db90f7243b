"""What the values of the first wrong step show, for a mistake that nothing else names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.oracle.naming.located import GO_THROUGH, located
from autograder.kit.oracle.outputs import Kind, Output
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Sequence

LAW = {"say it": "said"}


def told(path: str, came: Sequence[Any], asked: Sequence[Any], given: Sequence[Any] = ()) -> tuple[str, str]:
    """Return what a card says of outputs that differ, in steps with one input each, and the next step."""

    def run(steps: Sequence[Any]) -> Part:
        sent = [
            Event(0.0, "asked", "/said", {"fields": {"data": data}}) for data in given or range(len(steps))
        ]
        noted = [
            Event(
                0.0, "noted", "/said", {"step": step, "given": "/said", "values": [[one] for one in values]}
            )
            for step, values in enumerate(steps, 1)
        ]
        return Part("drawing 0", {}, [*sent, *noted])

    advice = located([Output("/said", (path,), Kind.STEPS, 1e-3)], run(came), run(asked), LAW)
    assert advice is not None
    return advice.text, advice.next_step


RISES = ([[[1, 2, 3]]], [[[3, 2, 1]]])


@pytest.mark.parametrize(
    ("path", "came", "asked", "given", "says"),
    [
        *cases(__file__, "what_the_first_wrong_values_show_is_said"),
        ("left", *RISES, (), "the task asks for numbers that go down"),
    ],
)
def test_what_the_first_wrong_values_show_is_said(
    path: str, came: Sequence[Any], asked: Sequence[Any], given: Sequence[Any], says: str
) -> None:
    text, next_step = told(path, came, asked, given)
    assert says in text
    assert "The task says" not in text
    assert next_step != GO_THROUGH


@pytest.mark.parametrize(
    ("path", "came", "asked", "given"),
    [
        *cases(__file__, "values_that_show_nothing_are_only_shown"),
        ("left", RISES[1], [[[3, 2, 2]]], ()),
        # more come another time
        ("data", [["a", "b", "c"], list("abcd")], [list("abcd"), list("abcd")], ()),
    ],
)
def test_values_that_show_nothing_are_only_shown(
    path: str, came: Sequence[Any], asked: Sequence[Any], given: Sequence[Any]
) -> None:
    text, next_step = told(path, came, asked, given)
    assert "The task says" in text
    assert next_step == GO_THROUGH


def test_an_answer_without_a_request_of_its_own_is_no_copy_of_one() -> None:
    run, due = (
        Part("a", {}, [Event(0.0, "noted", "/said", {"step": 1, "given": "/other", "values": [[success]]})])
        for success in (False, True)
    )
    advice = located([Output("/said", ("success",), Kind.STEPS, 1e-3)], run, due, LAW)
    assert advice is not None
    assert advice.next_step == GO_THROUGH


@pytest.mark.parametrize(
    ("events", "says"), cases(__file__, "an_answer_that_is_used_after_it_was_given_up_is_named")
)
def test_an_answer_that_is_used_after_it_was_given_up_is_named(events: str, says: str) -> None:
    kinds = {
        "input": ("sent", "/order"),
        "request": ("request", "/model"),
        "response": ("response", "/model"),
    }
    seen = [
        Event(0.0, *kinds.get(word, ("message", "/said")), {"fields": {"data": word}})
        for word in events.split()
    ]
    noted = [
        Event(0.0, "noted", "/said", {"step": 1, "given": "/order", "values": [[word]] if word else []})
        for word in ("done", "")
    ]
    output = Output("/said", ("data",), Kind.STEPS, 1e-3)
    advice = located([output], Part("a", {}, [*seen, noted[0]]), Part("a", {}, [noted[1]]), LAW)
    assert advice is not None
    assert says in advice.text
    assert (advice.next_step == GO_THROUGH) is not bool(says)


@pytest.mark.parametrize(("events", "given", "says"), cases(__file__, "what_set_the_time_going_is_said"))
def test_what_set_the_time_going_is_said(events: str, given: str, says: str) -> None:
    words = events.split()
    kinds = {"sent": ("sent", "/go"), "said": ("message", "/said"), "answer": ("response", "/where")}
    seen = [
        Event(
            float(at),
            *kinds.get(word, ("result_request", "/walk")),
            {"fields": {"data": number}, "known": word == "known"},
        )
        for number, (word, at) in enumerate(zip(words[::2], words[1::2], strict=True), 1)
    ]
    came = [["stop"]] * words.count("said")

    def noted(rows: list[list[str]]) -> Event:
        return Event(2.0, "noted", "/said", {"step": 1, "given": given, "values": rows})

    output = Output("/said", ("data",), Kind.STEPS, 1e-3)
    law = {"stop if nothing comes for 0.6 seconds": "said"}
    due = came[: len(came) - 1]
    advice = located([output], Part("a", {}, [*seen, noted(came)]), Part("a", {}, [noted(due)]), law)
    assert advice is not None
    assert says in advice.text
    assert (advice.next_step == GO_THROUGH) is not bool(says)


def test_messages_of_a_look_in_real_time_belong_to_no_step() -> None:
    """It notes all steps at its end: the last message of all is not the one that is not due in the first step."""
    output = Output("/said", ("data",), Kind.STEPS, 1e-3)
    sent = [Event(at, "sent", "/go", {"fields": {"data": at}}) for at in (1.0, 2.0)]
    said = [Event(at, "message", "/said", {"fields": {"data": "stop"}}) for at in (1.1, 2.9)]

    def run(first: list[list[str]]) -> Part:
        steps = enumerate((first, [["stop"]]), 1)
        noted = [
            Event(4.0, "noted", "/said", {"step": step, "given": "2 s without an input", "values": rows})
            for step, rows in steps
        ]
        return Part("a", {}, [*sent, *said, *noted])

    advice = located([output], run([["stop"]]), run([]), {"stop after 0.9 s": "said"})
    assert advice is not None
    assert advice.next_step == GO_THROUGH


@pytest.mark.parametrize(
    ("events", "due", "says"),
    [
        (
            "sent 1.0 sent 1.5 wait 1.9 said 2.1 wait 2.3",
            "1",
            "too late, 0.6 s after /go with 2: it looks as if",
        ),
        ("sent 1.0 sent 1.5 wait 1.9 said 2.25 wait 2.3", "1", ""),
        ("sent 1.0 sent 1.5 wait 1.9 said 2.1 wait 2.3", "1 2", ""),  # it is due there, too
        ("sent 1.0 wait 1.7 sent 2.0 said 2.6 wait 2.7", "1 2", "0.6 s after /go with 1, nothing comes"),
        ("sent 1.0 wait 1.5 sent 2.0 said 2.6 wait 2.7", "1 2", ""),  # the time is not over
        ("sent 1.0 wait 1.7 sent 2.0 wait 2.7", "1 2", ""),  # it never comes
    ],
)
def test_what_comes_too_late_or_not_at_all_by_the_time_is_said(events: str, due: str, says: str) -> None:
    words = events.split()
    seen: list[Event] = []
    asked: list[Event] = []
    came: list[list[str]] = []
    number = step = 0
    for word, at in zip(words[::2], map(float, words[1::2]), strict=True):
        if word == "sent":
            number += 1
            seen.append(Event(at, "sent", "/go", {"fields": {"data": number}}))
        elif word == "said":
            came.append(["stop"])
            seen.append(Event(at, "message", "/said", {"fields": {"data": "stop"}}))
        else:
            step += 1
            for run, values in ((seen, came), (asked, [["stop"]] * (str(step) in due))):
                data = {
                    "step": step,
                    "given": f"{at - seen[-1].moment:g} s without an input",
                    "values": values,
                }
                run.append(Event(at, "noted", "/said", data))
            came = []
    output = Output("/said", ("data",), Kind.STEPS, 1e-3)
    law = {"stop if nothing comes for 0.6 seconds": "said"}
    advice = located([output], Part("a", {}, seen), Part("a", {}, asked), law)
    assert advice is not None
    assert says in advice.text
    assert (advice.next_step == GO_THROUGH) is not bool(says)
