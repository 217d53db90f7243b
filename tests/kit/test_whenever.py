"""A card says with which word of an output, or of the input, another output is wrong each time, and only then."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.evidence import Event, Part
from autograder.kit.oracle.naming.located import located
from autograder.kit.oracle.naming.whenever import whenever
from autograder.kit.oracle.outputs import Kind, Output

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

ENDS = ("SUCCEEDED", "ABORTED", "SUCCEEDED", "ABORTED", "SUCCEEDED")
ABORTED = {1, 3}
SAID = Output("/said", ("data",), Kind.STEPS, 1e-3)
DOCK = Output("/dock", ("status", "arrived"), Kind.STEPS, 1e-3)


def run(
    said: Sequence[Any], arrived: Sequence[bool] = (True,) * 5, given: Sequence[str] = ("/go",) * 5
) -> Part:
    docked = [[list(pair)] for pair in zip(ENDS, arrived, strict=True)]
    return Part(
        "a",
        {},
        [
            Event(0.0, "noted", name, {"step": step, "given": given[step], "values": values})
            for name, column in (("/dock", docked), ("/said", said))
            for step, values in enumerate(column)
        ],
    )


def said(steps: Collection[int], word: str = "stop") -> list[list[list[str]]]:
    return [[[word]] if step in steps else [] for step in range(len(ENDS))]


def told(output: Output, seen: Part, due: Part) -> str:
    advice = whenever(output, seen, due, (SAID, DOCK))
    return advice.text if advice else ""


@pytest.mark.parametrize(
    ("came", "due", "text"),
    [
        (
            ABORTED,
            (),
            "Your node says something on /said, although nothing is due, each time that status on /dock is",
        ),
        (
            (),
            ABORTED,
            "Your node says nothing on /said each time that status on /dock is “ABORTED”, and only then.",
        ),
        ((1,), (), ""),
        ((1, 2, 3), (), ""),
        (range(5), (), ""),
    ],
)
def test_another_output_tells_when_this_one_is_wrong(
    came: Collection[int], due: Collection[int], text: str
) -> None:
    found = told(SAID, run(said(came)), run(said(due)))
    assert found.startswith(text)
    assert bool(found) is bool(text)


def test_the_card_quotes_the_line_that_sets_the_status() -> None:
    advice = whenever(SAID, run(said(ABORTED)), run(said(())), (SAID, DOCK))
    assert advice is not None
    assert advice.uses == ("abort",)
    assert "when status on /dock is “ABORTED”" in advice.next_step


def test_another_field_of_the_same_output_tells_it_only_if_it_is_right() -> None:
    seen, due = (run(said(()), arrived) for arrived in ((True,) * 5, (True, False) * 2 + (True,)))
    assert told(DOCK, seen, due).startswith(
        "Your node is wrong on /dock each time that status on /dock is “ABORTED”"
    )
    assert told(SAID, run(said(ABORTED)), run(said(ABORTED, "go"))).endswith("“ABORTED”, and only then.")


@pytest.mark.parametrize(
    ("due", "is_told"),
    [(said((0,)), True), (said(()), False)],  # what is due after no other input is wrong only then
)
def test_a_word_of_the_input_tells_it(due: list[Any], *, is_told: bool) -> None:
    output = Output("/said", ("data",), Kind.STEPS, 1e-3)
    given = ["[1.0, None]" if step in (1, 2) else "[1.0, 2.0]" for step in range(len(ENDS))]
    came = [[["far"]] if step in (1, 2) else values for step, values in enumerate(due)]
    text = told(output, run(came, given=given), run(due, given=given))
    assert text.endswith("each time that a value of the input is None, and only then.") is is_told


def test_a_sentence_about_the_values_themselves_stands_alone() -> None:
    numbers = Output("/said", ("left",), Kind.STEPS, 1e-3)
    seen, due = (
        run([[[values]] if n in ABORTED else [] for n in range(5)]) for values in ([1, 2, 3], [3, 2, 1])
    )
    advice = located([numbers, DOCK], seen, due, {})
    assert advice is not None
    assert "The numbers of your left on /said go up" in advice.text
    assert "only then" not in advice.text
