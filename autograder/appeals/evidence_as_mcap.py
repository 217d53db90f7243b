"""Writes the evidence of a check as MCAP: each event is a message in JSON, for Foxglove and other programs.

In the file, a message that the judge observed on a topic is on the same topic, and log lines are on ``/rosout``.
Requests, answers, goals and so on are on topics named after the service or action and the kind of event, such as
``/add_two_ints/asked``. All other events are on topics below ``/judge``. Each message has a field ``_judge``, which
contains the part of the check, the look (``quick`` or ``real time``), and the time by the judge's clock and by the
simulated clock.

A second kind of file, for ``ros2 bag play``, contains only the messages on topics, in ROS's own encoding (CDR) and with
the definitions of their types. All messages of such a file must have this encoding.

The times in the file put the parts of a check one after the other, in the order of the evidence.
"""

from __future__ import annotations

import json
from typing import IO, TYPE_CHECKING, Any

from autograder.judge.bench.ros_interfaces import filled, interface
from autograder.judge.evidence_files import plain
from autograder.mcap_files import ROS_2, MessageFile, definition

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from autograder.judge.evidence_files import Kept, KeptLook
    from autograder.kit.evidence import Event, Part


_ENDS = {"message": "publisher", "sent": "subscription"}
"""For each kind of event that is a message on a topic, the subject's endpoint on this topic.

An event of the kind ``message`` was published by the subject. One of the kind ``sent`` was published by the judge, for
the subject to receive.
"""
_OF_CALLS = (
    "asked", "answered", "request", "response", "goal", "goal_sent", "goal_answer", "goal_answered", "feedback",
    "feedback_heard", "cancel", "cancel_sent", "cancel_answer", "cancel_answered", "result_request", "result",
    "result_heard",
)  # fmt: skip
"""The kinds of events that are messages between the client and the server of a service or action."""
_JUDGE = "_judge"
"""The name of the field with the data that is not part of the message itself."""
_SECOND = 1_000_000_000


def write_messages(kept: Kept, stream: IO[bytes]) -> int:
    """Write the evidence of a check as an MCAP file, and return the number of messages.

    Args:
        kept: The evidence.
        stream: The stream to write to.
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


def write_bag(kept: Kept, stream: IO[bytes]) -> tuple[int, int]:
    """Write the messages on topics as ``ros2 bag record`` does. Return how many were written, and how many were not.

    A message is not written if the evidence does not contain its type, or if the type is not installed or has different
    fields now.

    Args:
        kept: The evidence.
        stream: The stream to write to.
    """
    file = MessageFile(stream, ROS_2)
    types = _types(kept)
    channels: dict[tuple[str, str], tuple[int, Any] | None] = {}
    written = left_out = 0
    for topic, event, nanoseconds, _ in _seen(kept):
        if event.kind not in _ENDS:
            continue
        key = topic, types.get((event.kind, topic), "")
        if key not in channels:
            channels[key] = _channel_in_cdr(file, *key)
        channel = channels[key]
        try:
            data = _in_cdr(channel[1], event.data.get("fields", {})) if channel is not None else None
        except (AttributeError, AssertionError, OverflowError, TypeError, ValueError):
            data = None  # the type has different fields now
        if channel is None or data is None:
            left_out += 1
            continue
        file.add(channel[0], data, arrived=nanoseconds, sent=nanoseconds)
        written += 1
    file.close()
    return written, left_out


def _in_cdr(kind: Any, fields: Mapping[str, Any]) -> bytes:
    from rclpy.serialization import serialize_message

    return bytes(serialize_message(filled(kind(), fields)))


def _channel_in_cdr(file: MessageFile, topic: str, type_name: str) -> tuple[int, Any] | None:
    """Declare a topic in the MCAP file (as a *channel* of MCAP), for messages in ROS's encoding, CDR.

    Return the number of the channel and the class of the messages; None if the message type is not installed.
    """
    try:
        # Look for the definition first, because this fails if the name in the file is not that of a message type. To
        # find the class, Python imports the module with this name, which could be any module.
        text = definition(type_name)
        kind = interface(type_name)
    except LookupError:
        return None
    channel = file.channel(topic, type_name, text, about={"offered_qos_profiles": ""})
    return channel, kind


def _seen(kept: Kept) -> Iterator[tuple[str, Event, int, dict[str, Any]]]:
    """Yield each event of the evidence with the topic, time and content of the message to write."""
    began = kept.at - kept.verdict.seconds
    for look in kept.looks:
        for part in look.parts:
            for event in part.events:
                nanoseconds = max(0, round((began + event.t) * _SECOND))
                yield _topic(event), event, nanoseconds, _message(look, part, event)
            began += max((event.t for event in part.events), default=0.0)


def _topic(event: Event) -> str:
    if event.kind in _ENDS:
        return event.name
    if event.kind == "log":
        return "/rosout"
    return f"{event.name}/{event.kind}" if event.kind in _OF_CALLS else f"/judge/{event.kind}"


def _message(look: KeptLook, part: Part, event: Event) -> dict[str, Any]:
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
    """Return the message types in the evidence, each with its kind of event and topic as the key."""
    return {
        (kind, topic): str(type_name)
        for look in kept.looks
        for part in look.parts
        for event in part.events
        if event.kind == "interface"
        for kind, role in _ENDS.items()
        for topic, type_name in event.data.get(role, {}).items()
    }


_JSON_TYPES = {
    bool: "boolean",
    int: "number",
    float: "number",
    str: "string",
    list: "array",
    dict: "object",
}


def _extend(schema: dict[str, Any], value: Any) -> None:
    """Extend a JSON Schema so that it also allows this value."""
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
    kind = _JSON_TYPES[type(value)]
    if schema.setdefault("type", kind) != kind:
        # The values of this field have different types. JSON Schema then says ``string``, so that programs show all of
        # them.
        schema["type"] = "string"
