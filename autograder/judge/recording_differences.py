"""Compares two recordings of a solution, and says in words what differs.

Recordings are compared topic by topic, with a tolerance for numbers. What chance decides is not compared: the order of
events on different topics, and the time of a topic's first event, at which the judge may only begin to step the clock.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from autograder.kit.in_words import counted
from autograder.kit.rules import SIMULATED_JITTER, same

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Event, Part, Reference

LONGEST = 160
"""The maximum number of characters of a value in a line."""


def differences(before: Reference, now: Reference, tolerance: float) -> Iterator[str]:
    """Yield a line for each difference between two recordings; for events, only the first one of a topic in a part.

    Args:
        before: The stored recording.
        now: The new recording.
        tolerance: The tolerance for numbers, absolute or relative to the larger one.
    """
    yield from _changed("the solution's endpoints", dict(before.interface), dict(now.interface))
    yield from _changed("the QoS of the solution's endpoints", dict(before.qos), dict(now.qos))
    yield from _of_parts("", before.parts, now.parts, tolerance)
    old, new = ({variant.key: variant for variant in one.variants} for one in (before, now))
    yield from _changed("the recorded wrong answers", [*old], [*new])
    for key in (key for key in old if key in new):
        first, then = old[key], new[key]
        yield from _changed(f"{key}: the card", [first.text, first.next_step], [then.text, then.next_step])
        yield from _of_parts(f"{key}, ", first.parts, then.parts, tolerance)


def _of_parts(whose: str, before: Sequence[Part], now: Sequence[Part], tolerance: float) -> Iterator[str]:
    old, new = ({part.name: part for part in parts} for parts in (before, now))
    yield from _changed(f"{whose}the parts", [*old], [*new])
    for name in (name for name in old if name in new):
        yield from _changed(f"{whose}{name}: the inputs", dict(old[name].inputs), dict(new[name].inputs))
        first, then = _by_topic(old[name]), _by_topic(new[name])
        for topic in dict.fromkeys((*first, *then)):
            where = f"{whose}{name}, {' '.join(topic)}"
            difference = _of_topic(first.get(topic, []), then.get(topic, []), tolerance)
            if difference:
                yield f"{where}{difference}"


def _by_topic(part: Part) -> dict[tuple[str, str], list[Event]]:
    topics: dict[tuple[str, str], list[Event]] = {}
    for event in part.events:
        topics.setdefault((event.kind, event.name), []).append(event)
    return topics


def _of_topic(before: Sequence[Event], now: Sequence[Event], tolerance: float) -> str:
    """Return in words the first difference between the events of one topic; empty if there is none."""
    for number, (first, then) in enumerate(zip(before, now, strict=False), 1):
        other = [
            key
            for key in {**first.data, **then.data}
            if not same(first.data.get(key), then.data.get(key), tolerance)
        ]
        if other:
            at = "".join(
                f", {key} {value}" for key, value in first.data.items() if key not in other and value != ""
            )
            was, is_now = ({key: event.data.get(key) for key in other} for event in (first, then))
            return f", number {number}{at}: {_was(was, is_now)}"
    if len(before) != len(now):
        return f": {counted(len(before), 'time')} before, {counted(len(now), 'time')} now"
    # The jump to the simulated time distorts the first time, and some first events come before it.
    times = [
        (a.sim, b.sim) for a, b in zip(before, now, strict=True) if a.sim is not None and b.sim is not None
    ][1:]
    for number, (sim, sim_now) in enumerate(times, 2):
        late, late_now = sim - times[0][0], sim_now - times[0][1]
        if abs(late - late_now) > SIMULATED_JITTER + 1e-6:
            return f": number {number} came {late:g} s after the second before, {late_now:g} s now"
    return ""


def _changed(what: str, before: Any, now: Any) -> Iterator[str]:
    if before != now:
        yield f"{what}: {_was(before, now)}"


def _was(before: Any, now: Any) -> str:
    was, is_now = (_shown(value) for value in (before, now))
    return f"{was} before, {is_now} now"


def _shown(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}…"
