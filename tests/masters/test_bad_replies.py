"""Lab 2.5's table of bad replies: what reached the robot from two nodes, by the kept evidence."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from autograder.authoring.answer_bank import answers
from tests.measure import evidence

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.kit.evidence import Event

EXERCISES = ("lab_2_5.asks", "lab_2_5.late")
NODES = {"solution": "right/usual.py", "careless node": "wrong/unknown_does_what_it_finds.py"}
"""The answer behind each column of the table, whose first column has the reply."""
LAB = next(Path(__file__).parents[2].glob("solutions/*/lab_2_5/lab.md"))
ROW = re.compile(r"^\|[^|`]*`([^|]+)` \| ([^|]+) \| ([^|]+) \|$", re.MULTILINE)
SENT = {"request": "`/lamp`: {data}", "goal": "`/walk_to`: {x}, {y}"}
"""What an event is called in the table: a request or a goal of the node."""
ROWS = [(reply, dict(zip(NODES, sent, strict=True))) for reply, *sent in ROW.findall(LAB.read_text("utf-8"))]


def seen(exercise: str, answer: str) -> Iterable[Event]:
    """What the judge saw of an answer of the bank."""
    name = f"{exercise}/{answer}"
    found = next(one for one in answers([exercise]) if one.name == name)
    record = evidence.record_of(found, evidence.kept(exercise).get(name))
    return (event for part in record.seen.looks[0].parts for event in part.events)


def sent_after_replies(node: str) -> dict[str, set[str]]:
    """What a node sent between each reply of the model and what the judge gave it next, by the reply."""
    found: dict[str, set[str]] = {}
    for exercise in EXERCISES:
        reply, sent = "", list[str]()
        for event in [*seen(exercise, NODES[node]), None]:
            is_reply = event is not None and (event.kind, event.name) == ("response", "/model")
            if is_reply or event is None or event.kind == "sent":
                found.setdefault(reply, set()).add(", ".join(sent) or "nothing")
                reply, sent = fields(event)["reply"] if is_reply else "", []
            elif event.kind in SENT and event.name in ("/lamp", "/walk_to"):
                sent.append(SENT[event.kind].format(**fields(event)))
    return found


def fields(event: Any) -> dict[str, Any]:
    return dict(event.data["fields"])


def test_six_bad_replies_are_in_the_table() -> None:
    assert len({reply for reply, _ in ROWS}) == len(ROWS) == 6


@pytest.mark.parametrize("node", NODES)
def test_the_table_says_what_was_on_the_wire(node: str) -> None:
    found = sent_after_replies(node)
    assert {reply: {sent[node]} for reply, sent in ROWS} == {reply: found.get(reply) for reply, _ in ROWS}
