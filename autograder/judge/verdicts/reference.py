"""Reads and writes reference outputs: what the reference solutions do on the wire, as JSON that people can review.

The file contains only what the task determines, such as messages, requests and answers. Facts that differ from run to
run are left out, such as wall times, random node names and the order of log lines from two channels.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from autograder.exercises import reference_path
from autograder.kit.evidence import Event, Part, Reference
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_KEPT = (
    "message", "sent", "request", "response", "goal", "feedback", "cancel", "result", "asked", "answered",
    "goal_sent", "goal_answer", "feedback_heard", "cancel_sent", "cancel_answer", "result_heard",
    "said", "type",
)  # fmt: skip

_ON_THE_WAY = ("feedback_heard", "result_heard")
_MACHINE = ("number", "sent", "arrived")
"""The fields of an event that differ from run to run, and so are not recorded."""


class NoReference(LookupError):
    """The reference output of an exercise does not exist or cannot be read."""


def load(exercise_id: str) -> Reference:
    """Read a reference output.

    Raises:
        NoReference: The file does not exist, or is not a reference output.
    """
    file = reference_path(exercise_id)
    try:
        return parse(json.loads(file.read_text(encoding="utf-8")))
    except FileNotFoundError as error:
        raise NoReference(f"{file} does not exist: run `{COMMAND} record {exercise_id}`") from error
    except (ValueError, KeyError, TypeError) as error:
        raise NoReference(
            f"{file} is not a reference output ({error}): run `{COMMAND} record {exercise_id}`"
        ) from error


def digest(exercise_id: str) -> str:
    """Return the SHA-256 of a reference output's file, in hexadecimal.

    Raises:
        NoReference: The file cannot be read.
    """
    file = reference_path(exercise_id)
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError as error:
        raise NoReference(f"{file} cannot be read: run `{COMMAND} record {exercise_id}`") from error


def parse(data: Mapping[str, Any]) -> Reference:
    """Return a reference output from its JSON form."""
    parts = [
        Part(
            part["name"],
            part["inputs"],
            [
                Event(e.get("t", 0.0), e["kind"], e["name"], e.get("data", {}), e.get("sim"))
                for e in part["events"]
            ],
        )
        for part in data["parts"]
    ]
    return Reference(data["exercise"], data["interface"], parts)


def dump(reference: Reference, kinds: Sequence[str] | None = None) -> str:
    """Return a recording as JSON, with one line for each event. Recordings of the same behavior give the same text.

    Args:
        reference: The recording.
        kinds: The kinds of events to write; None for the usual kinds.
    """
    if kinds is not None:
        parts = [replace(p, events=[e for e in p.events if e.kind in kinds]) for p in reference.parts]
        reference = replace(reference, parts=parts)
    head = {"exercise": reference.exercise, "interface": _sorted(reference.interface)}
    lines = json.dumps(head, indent=1, ensure_ascii=False).splitlines()[:-1]
    return (
        "\n".join(
            [*lines[:-1], lines[-1] + ",", ' "parts": [', ",\n".join(map(_part, reference.parts)), " ]", "}"]
        )
        + "\n"
    )


def _part(part: Part) -> str:
    events = ",\n".join(f"   {json.dumps(event, ensure_ascii=False)}" for event in _events(part))
    name, inputs = (json.dumps(value, ensure_ascii=False) for value in (part.name, dict(part.inputs)))
    return f'  {{"name": {name}, "inputs": {inputs}, "events": [\n{events}\n  ]}}'


def _sorted(interface: Mapping[str, Mapping[str, str]]) -> dict[str, dict[str, str]]:
    return {role: dict(sorted(names.items())) for role, names in sorted(interface.items()) if names}


def _events(part: Part) -> list[dict[str, Any]]:
    kept = [event for event in part.events if event.kind in _KEPT]
    # Leave out the feedback and the result of a canceled goal: how far the goal gets depends on the machine.
    canceled = {event.data["goal"] for event in kept if event.kind == "cancel_sent"}
    kept = [e for e in kept if not (e.kind in _ON_THE_WAY and e.data["goal"] in canceled)]
    # If goals run at the same time in one part, the order of their events depends on the machine. So sort the events by
    # goal, with the answer before the feedback.
    kept.sort(key=lambda event: (event.data.get("goal", 0), event.kind not in ("goal_sent", "goal_answer")))
    start = next((event.sim for event in kept if event.sim is not None), None)
    return [_event(event, start) for event in kept]


def _event(event: Event, start: float | None) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": event.kind, "name": event.name}
    if event.sim is not None and start is not None:
        row["sim"] = round(event.sim - start, 3)
    return row | {"data": {name: value for name, value in event.data.items() if name not in _MACHINE}}
