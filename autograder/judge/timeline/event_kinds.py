"""The kinds of events that a card's timeline shows, with the direction and the label of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from autograder.kit.outcomes import STATUS
from autograder.kit.output.spoken_lines import spoken_by

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.kit.evidence import Event


MAX_LABEL = 200
"""The maximum length of a moment's label, in characters."""


def _fields(data: Mapping[str, Any]) -> str:
    fields = data.get("fields", {})
    inner = any(isinstance(value, Mapping) for value in fields.values())
    if len(fields) == 1 and not inner:
        return str(next(iter(fields.values())))
    leaves = dict(_leaves(fields))
    # Most fields of nested messages are zero, so only the other fields are shown.
    told = [f"{name}={value}" for name, value in leaves.items() if value or not inner]
    return ", ".join(told) or ("all 0" if inner else "")


def _goal(data: Mapping[str, Any]) -> str:
    """Return a goal's label, such as ``goal, order 5``: ``goal 5`` would look like the fifth goal."""
    fields = data.get("fields", {})
    name = next(iter(fields), "") if len(fields) == 1 else ""
    return f"goal, {name} {_fields(data)}" if name else f"goal {_fields(data)}"


def _leaves(fields: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in fields.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value


class _Kind(NamedTuple):
    """A kind of event that the timeline shows.

    Attributes:
        direction: The direction of the message: from the subject, to the subject, or neither.
        label: Returns the label of an event's dot.
        key: True if such events are important and therefore always shown.
        numbered: True if such events contain the number of a goal that the judge has sent.
    """

    direction: str
    label: Callable[[Event], str] = lambda event: _fields(event.data)
    key: bool = False
    numbered: bool = False


HEARD, _SENT, _NOTE = "from_subject", "to_subject", "note"
KINDS = {
    "message": _Kind(HEARD),
    "sent": _Kind(_SENT),
    "request": _Kind(HEARD),
    "response": _Kind(_SENT),
    "goal": _Kind(HEARD, lambda e: _goal(e.data), key=True),
    "feedback": _Kind(_SENT),
    "cancel": _Kind(HEARD, lambda _: "cancel request", key=True),
    "result_request": _Kind(HEARD, lambda _: "asks for the result"),
    "result": _Kind(_SENT, lambda e: f"{str(e.data['status']).upper()} {_fields(e.data)}".rstrip(), key=True),
    "asked": _Kind(_SENT),
    "answered": _Kind(HEARD),
    "goal_sent": _Kind(_SENT, lambda e: _goal(e.data), key=True, numbered=True),
    "goal_answer": _Kind(HEARD, lambda e: "accepted" if e.data["accepted"] else "rejected", numbered=True),
    "feedback_heard": _Kind(HEARD, numbered=True),
    "cancel_sent": _Kind(_SENT, lambda _: "cancel request", key=True, numbered=True),
    "cancel_answer": _Kind(
        HEARD, lambda e: "will cancel" if e.data["accepted"] else "will not cancel", numbered=True
    ),
    "result_heard": _Kind(
        HEARD,
        lambda e: f"{STATUS.get(e.data['status'], e.data['status'])} {_fields(e.data)}",
        key=True,
        numbered=True,
    ),
    "log": _Kind(HEARD, lambda e: str(e.data["text"])),
    "output": _Kind(HEARD, lambda e: spoken_by(e) or ""),
    "mismatch": _Kind(_NOTE, lambda e: f"{e.data['policy']} does not fit", key=True),
    "subject": _Kind(_NOTE, lambda e: e.name.replace("_", " ")),
}


def label_of(event: Event) -> str:
    """Return the label of an event's dot, cut to :data:`MAX_LABEL` characters."""
    text = KINDS[event.kind].label(event)
    return text if len(text) <= MAX_LABEL else f"{text[: MAX_LABEL - 1]}…"
