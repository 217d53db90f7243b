"""What a judge saw in a check, as MCAP: each event a message in JSON, for Foxglove and other programs.

Messages are on their own topic and the log is on ``/rosout``; requests, answers, goals and the like are on the name of
the service or action with the word of the transcript, such as ``/add_two_ints/asked``; all else is below ``/judge``.
Beside its fields each message has under ``_judge`` what else is known: in which part and look, and when by the judge's
watch and by the simulated clock.

The runs of a check stand one after the other, in the order of the evidence.
"""

from __future__ import annotations

import json
from typing import IO, TYPE_CHECKING, Any

from autograder.judge.verdicts.keeping import plain
from autograder.message_files import MessageFile

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.judge.verdicts.keeping import Kept, KeptEvent, KeptLook, KeptPart

_ENDS = {"message": "publisher", "sent": "subscription"}
"""What the subject has on a topic on which it is heard, and on one on which it is spoken to."""
_OF_CALLS = (
    "asked", "answered", "request", "response", "goal", "goal_sent", "goal_answer", "goal_answered", "feedback",
    "feedback_heard", "cancel", "cancel_sent", "cancel_answer", "cancel_answered", "result_request", "result",
    "result_heard",
)  # fmt: skip
"""What goes to and fro between the client and the server of a service or an action."""
_JUDGE = "_judge"
"""The field of what no message says of itself."""
_SECOND = 1_000_000_000


def write_messages(kept: Kept, stream: IO[bytes]) -> int:
    """Write an MCAP file of a check; how many messages are in it.

    Args:
        kept: What was seen.
        stream: Where to.
    """
    file = MessageFile(stream)
    seen = list(_seen(kept))
    schemas: dict[tuple[str, str], dict[str, Any]] = {}
    for topic, event, _, message in seen:
        _extend(schemas.setdefault((topic, event.kind), {"type": "object"}), message)
    types = _types(kept)
    channels: dict[tuple[str, str], int] = {}
    for topic, event, nanoseconds, message in seen:
        key = topic, event.kind
        if key not in channels:
            name = types.get((event.kind, event.name), event.kind)
            definition = json.dumps(schemas[key])
            channels[key] = file.channel(topic, name, definition, as_json=True, about={"seen_as": event.kind})
        data = json.dumps(message, allow_nan=False).encode()
        file.add(channels[key], data, arrived=nanoseconds, sent=nanoseconds)
    verdict = kept.verdict
    file.note(
        "check",
        {
            "exercise": verdict.exercise,
            "state": verdict.state,
            "score": f"{verdict.score:g}",
            "max_score": f"{verdict.max_score:g}",
            "diagnosis": verdict.diagnosis.key if verdict.diagnosis else "",
            "seed": verdict.seed,
            "cut": kept.cut,
        },
    )
    file.close()
    return len(seen)


def _seen(kept: Kept) -> Iterator[tuple[str, KeptEvent, int, dict[str, Any]]]:
    """Each event with its topic, its time and its message."""
    began = kept.at - kept.verdict.seconds
    for look in kept.looks:
        for part in look.parts:
            for event in part.events:
                nanoseconds = max(0, round((began + event.t) * _SECOND))
                yield _topic(event), event, nanoseconds, _message(look, part, event)
            began += max((event.t for event in part.events), default=0.0)


def _topic(event: KeptEvent) -> str:
    if event.kind in _ENDS:
        return event.name
    if event.kind == "log":
        return "/rosout"
    return f"{event.name}/{event.kind}" if event.kind in _OF_CALLS else f"/judge/{event.kind}"


def _message(look: KeptLook, part: KeptPart, event: KeptEvent) -> dict[str, Any]:
    fields = event.data.get("fields", {})
    more = {key: value for key, value in event.data.items() if key != "fields"}
    return {
        **plain(fields),
        _JUDGE: {
            "look": "real time" if look.real_time else "quick",
            "part": part.name,
            "kind": event.kind,
            "name": event.name,
            "t": event.t,
            "sim": event.sim,
            **plain(more),
        },
    }


def _types(kept: Kept) -> dict[tuple[str, str], str]:
    """The types of topics, as the graph had them: by the kind of event and the topic's name."""
    return {
        (kind, topic): str(type_name)
        for look in kept.looks
        for part in look.parts
        for event in part.events
        if event.kind == "interface"
        for kind, role in _ENDS.items()
        for topic, type_name in event.data.get(role, {}).items()
    }


def _extend(schema: dict[str, Any], value: Any) -> None:
    """Have a JSON Schema allow one more value."""
    if isinstance(value, dict):
        properties = schema.setdefault("properties", {})
        for key, inner in value.items():
            if inner is not None:
                _extend(properties.setdefault(key, {}), inner)
    elif isinstance(value, list):
        items = schema.setdefault("items", {})
        for inner in value:
            if inner is not None:
                _extend(items, inner)
    kind = _kind(value)
    if schema.setdefault("type", kind) != kind:
        schema["type"] = "string"  # two kinds: a reader shows it as text


def _kind(value: Any) -> str:
    kinds = {bool: "boolean", int: "number", float: "number", str: "string", list: "array", dict: "object"}
    return kinds[type(value)]
