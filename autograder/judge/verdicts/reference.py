"""Reads and writes reference outputs: what the reference solutions do on the wire, as JSON that people can review.

A recording keeps what the task decides (messages, requests, answers) and drops what the machine decides (wall times,
random node names, the order of log lines between two channels).
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
"""Fields of an event that differ from run to run."""


class NoReference(LookupError):
    """The reference output of an exercise does not exist or cannot be read."""


def load(exercise_id: str) -> Reference:
    """Read a reference output.

    Raises:
        NoReference: It does not exist or is not what :func:`dump` writes.
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
    """Return the SHA-256 of a reference output's file.

    Raises:
        NoReference: The file does not exist.
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
    """Return the JSON form with one line for each event. Recordings of the same behavior have the same form.

    Args:
        reference: The recording.
        kinds: The kinds of events to keep; None for the usual ones.
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
    # How far a goal gets before it is canceled depends on the machine, so that feedback is left out.
    canceled = {event.data["goal"] for event in kept if event.kind == "cancel_sent"}
    kept = [e for e in kept if not (e.kind in _ON_THE_WAY and e.data["goal"] in canceled)]
    # Goals that run at the same time share one part. Sort them, because it depends on the machine which goal is ahead
    # and whether the first feedback arrives before the answer to its goal.
    kept.sort(key=lambda event: (event.data.get("goal", 0), event.kind not in ("goal_sent", "goal_answer")))
    start = next((event.sim for event in kept if event.sim is not None), None)
    return [_event(event, start) for event in kept]


def _event(event: Event, start: float | None) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": event.kind, "name": event.name}
    if event.sim is not None and start is not None:
        row["sim"] = round(event.sim - start, 3)
    return row | {"data": {name: value for name, value in event.data.items() if name not in _MACHINE}}
