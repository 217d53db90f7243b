"""From events to the dots of the card's timeline."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.verdict import Moment

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from autograder.exercises.evidence import Event, Evidence

MAX_MOMENTS = 80
"""Moments that a verdict carries; the first ones tell the story."""

MAX_LABEL = 200
"""Characters of one of them."""

_DIRECTION = {
    "message": "from_subject",
    "sent": "to_subject",
    "request": "from_subject",
    "response": "to_subject",
    "goal": "from_subject",
    "feedback": "to_subject",
    "cancel": "from_subject",
    "result_request": "from_subject",
    "result": "to_subject",
    "asked": "to_subject",
    "answered": "from_subject",
    "goal_sent": "to_subject",
    "goal_answer": "from_subject",
    "feedback_heard": "from_subject",
    "cancel_sent": "to_subject",
    "cancel_answer": "from_subject",
    "result_heard": "from_subject",
    "log": "from_subject",
    "mismatch": "note",
    "subject": "note",
}


def moments(evidence: Evidence) -> tuple[Moment, ...]:
    """What was on the wire, in order."""
    found = [
        Moment(
            t=_time(event, start),
            lane="log" if event.kind == "log" else "your code" if event.kind == "subject" else event.name,
            direction=_DIRECTION[event.kind],
            label=_label(event),
            part=part.name if len(evidence.parts) > 1 else "",
            simulated=start is not None,
        )
        for part in evidence
        for start in [next((e.sim for e in part.events if e.sim is not None), None)]
        for event in part.events
        if event.kind in _DIRECTION
    ]
    return tuple(found[:MAX_MOMENTS])


def _time(event: Event, start: float | None) -> float:
    """Seconds on the axis of the event's part: simulated ones from ``start`` on, where the clock was stepped."""
    if start is None:
        return round(event.t, 3)
    return 0.0 if event.sim is None else round(event.sim - start, 3)


def _fields(data: Mapping[str, Any]) -> str:
    fields = data.get("fields", {})
    if len(fields) == 1:
        return str(next(iter(fields.values())))
    return ", ".join(f"{name}={value}" for name, value in fields.items())


_LABELS: dict[str, Callable[[Event], str]] = {
    "goal": lambda e: f"goal {_fields(e.data)}",
    "cancel": lambda _: "cancel request",
    "result_request": lambda _: "asks for the result",
    "result": lambda e: str(e.data["status"]),
    "goal_sent": lambda e: f"goal {_fields(e.data)}",
    "goal_answer": lambda e: "accepted" if e.data["accepted"] else "refused",
    "cancel_sent": lambda _: "cancel request",
    "cancel_answer": lambda e: "will cancel" if e.data["accepted"] else "will not cancel",
    "result_heard": lambda e: f"status {e.data['status']}: {_fields(e.data)}",
    "log": lambda e: str(e.data["text"]),
    "mismatch": lambda e: f"{e.data['policy']} does not fit",
    "subject": lambda e: e.name.replace("_", " "),
}


def _label(event: Event) -> str:
    label = _LABELS.get(event.kind)
    text = label(event) if label else _fields(event.data)
    return text if len(text) <= MAX_LABEL else f"{text[: MAX_LABEL - 1]}…"
