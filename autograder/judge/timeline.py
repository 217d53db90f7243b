"""From events to the dots of the card's timeline."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from autograder.exercises.evidence import Event, Evidence
from autograder.verdict import Moment

MAX_MOMENTS = 80
"""Moments that a verdict carries; the first ones tell the story."""

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
    "log": "from_subject",
    "mismatch": "note",
    "subject": "note",
}


def moments(evidence: Evidence) -> tuple[Moment, ...]:
    """What was on the wire, in order."""
    found = [
        Moment(
            t=_time(event, start),
            lane="log" if event.kind == "log" else "subject" if event.kind == "subject" else event.name,
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
    "cancel": lambda e: "cancel request",
    "result_request": lambda e: "asks for the result",
    "result": lambda e: str(e.data["status"]),
    "log": lambda e: str(e.data["text"]),
    "mismatch": lambda e: f"{e.data['policy']} does not fit",
    "subject": lambda e: e.name.replace("_", " "),
}


def _label(event: Event) -> str:
    return _LABELS.get(event.kind, lambda e: _fields(e.data))(event)
