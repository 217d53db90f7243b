"""Chooses the events that a card's timeline shows as dots."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.judge.timeline.event_kinds import HEARD, KINDS, label_of
from autograder.kit.output.spoken_lines import spoken_by
from autograder.kit.output.workspace_reports import build_ended
from autograder.verdict import Moment

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from autograder.kit.evidence import Event, Evidence, Part, Reference


MAX_MOMENTS = 80
"""The maximum number of moments in a verdict. All important moments are kept, and the first of the other moments."""
MOST_MOMENTS = 120
"""The maximum number of moments if more than :data:`MAX_MOMENTS` are important, as when a program sends goals forever.
"""

EXPECTED = 5
"""The maximum number of missing messages that a failed card shows for each topic, beginning with the first."""

ASKED = " (asked)"
"""The end of the name of the lane that shows what was expected and did not come, apart from what the subject sent."""

_INPUTS = ("sent", "asked")
"""The kinds of events that are inputs for the subject: the judge sent a message, or called the subject's service."""

_ENDS = ("publisher", "subscription", "service", "client", "action_server", "action_client")
_LANES = {"log": "log", "output": "printed", "subject": "your code"}
"""The lanes of events that belong to no topic, service or action, by their kinds."""


_Said = tuple[float, str]
"""The time of a message in seconds, and the label of the message."""
_QUOTED = re2.compile(r"“([^”…]*\w[^”…]*)")


def moments(evidence: Evidence, words: str = "", *, missed: bool = False) -> tuple[Moment, ...]:
    """Return the moments of the timeline, in order. If there are too many, keep the important and the first ones.

    Args:
        evidence: The evidence of the check.
        words: The text of the card. The timeline contains each logged or printed line that this text quotes.
        missed: True to add the reference solution's messages that the subject did not send, each at the time when it
            was due.
    """
    several = len(evidence.parts) > 1
    quoted = tuple(dict.fromkeys(_QUOTED.findall(words)))
    found = [
        moment
        for part in evidence
        for moment in _of_part(part, evidence.reference, part.name if several else "", quoted, missed)
    ]
    room = MAX_MOMENTS - sum(moment.key for moment in found)
    kept = []
    for moment in found:
        room -= not moment.key
        if moment.key or room >= 0:
            kept.append(moment)
    return tuple(kept[:MOST_MOMENTS])


def _since_the_build(part: Part) -> Part:
    """Return the part with times counted from the end of the build, because the program starts only after the build."""
    built = build_ended(part)
    if not built:
        return part
    return replace(part, events=[replace(event, t=max(event.t - built, 0.0)) for event in part.events])


def _first_said(part: Part, quoted: Sequence[str]) -> dict[int, Event]:
    """Return, for each quoted text, the first event that begins with it: a log line if possible, else output."""
    found: dict[str, Event] = {}
    for event in sorted(part.events if quoted else (), key=lambda event: event.kind == "output"):
        said = spoken_by(event) if event.kind in ("log", "output") else None
        for text in quoted:
            if said and said.startswith(text):
                found.setdefault(text, event)
    return {id(event): event for event in found.values()}


def _of_part(
    part: Part, reference: Reference, title: str, quoted: Sequence[str], missed: bool
) -> list[Moment]:
    part = _since_the_build(part)
    start = next((e.sim for e in part.events if e.sim is not None), None)
    told = _first_said(part, quoted)
    shown = [
        event
        for event in _under_real_names(part)
        if event.kind in KINDS and not _began(event) and (event.kind != "output" or id(event) in told)
    ]
    lanes = lane_names(shown)
    unlike = _first_unlike(shown, part, reference)
    found = [
        (
            # Events at the same simulated time are sorted by the time at which they were sent.
            (_time(event, start), _said_at(event)),
            Moment(
                t=_time(event, start),
                lane=lane,
                direction=KINDS[event.kind].direction,
                label=label_of(event),
                part=title,
                simulated=start is not None,
                key=KINDS[event.kind].key
                or event is unlike
                or id(event) in told
                or (event.kind == "subject" and event.name == "raised"),
            ),
        )
        for event, lane in zip(shown, lanes, strict=True)
    ]
    found += [((moment.t, moment.t), moment) for moment in _astray(part, reference, title, start)]
    if missed:  # sort each missing message after the events that happened at the same time
        found += [((moment.t, math.inf), moment) for moment in _missed(part, reference, title, start)]
    return [moment for _, moment in sorted(found, key=lambda pair: pair[0])]


def _said_at(event: Event) -> float:
    """Return when the event was sent or, if unknown, when it arrived, in seconds of wall time since the part began."""
    sent, arrived = event.data.get("sent"), event.data.get("arrived")
    if not isinstance(sent, float) or not isinstance(arrived, float):
        return event.t
    return min(max(event.t - max(arrived - sent, 0.0), 0.0), event.t)


def _time(event: Event, start: float | None) -> float:
    """Return the event's seconds on the time axis: simulated time since ``start``; wall time if ``start`` is None."""
    if start is None:
        return round(_said_at(event), 3)
    return 0.0 if event.sim is None else round(event.sim - start, 3)


def _began(event: Event) -> bool:
    """Return True if the event only says that the subject was started or constructed. Such events are not shown."""
    return event.kind == "subject" and event.name in ("started", "constructed")


def _without_echoes(events: Iterable[Event]) -> Iterator[Event]:
    """Yield all events except the judge's own messages that its own subscription has received."""
    on_their_way: Counter[str] = Counter()
    for event in events:
        if event.kind in ("sent", "message"):
            text = repr((event.name, event.data.get("fields")))
            if event.kind == "sent":
                on_their_way[text] += 1
            elif on_their_way[text]:
                on_their_way[text] -= 1
                continue
        yield event


def _under_real_names(part: Part) -> Iterator[Event]:
    """Yield the events with the names that the subject gave to topics, services and actions."""
    real = {event.name: event.data["real"] for event in part.of("misnamed")}
    for event in _without_echoes(part.events):
        yield replace(event, name=real[event.name]) if event.name in real else event


def lane_names(events: Sequence[Event]) -> list[str]:
    """Return the lane of each event: the topic, service or action, with the number of the goal if there are several."""
    number: dict[str, int] = {}
    numbers = []
    for event in events:
        if event.kind == "goal":
            number[event.name] = number.get(event.name, -1) + 1
        own = event.data.get("goal") if KINDS[event.kind].numbered else None
        numbers.append(own if isinstance(own, int) and own >= 0 else number.get(event.name, 0))
    several = {event.name for event, number in zip(events, numbers, strict=True) if number > 0}
    return [
        _LANES.get(event.kind)
        or (f"{event.name}, goal {number + 1}" if event.name in several else event.name)
        for event, number in zip(events, numbers, strict=True)
    ]


def _first_unlike(events: Sequence[Event], part: Part, reference: Reference) -> Event | None:
    """Return the first message with fields that the reference solution did not send on this topic; None if none."""
    known = next((other for other in reference.parts if other.name == part.name), None)
    for event in events:
        if event.kind == "message" and known is not None:
            expected = [other.data.get("fields") for other in known.of("message", event.name)]
            if expected and event.data.get("fields") not in expected:
                return event
    return None


def _astray(part: Part, reference: Reference, title: str, start: float | None) -> Iterator[Moment]:
    """Yield a moment for each missing endpoint, and for each unexpected endpoint with the role of a missing one."""
    for role in _ENDS:
        noun = role.replace("_", " ")
        expected = set(reference.interface.get(role, {}))
        missing = expected - set(part.endpoints(role))
        if not missing:
            continue
        seen: set[str] = set()
        for survey in part.of("interface"):
            for name in sorted(set(survey.data.get(role, {})) - expected - seen):
                seen.add(name)
                t = _time(survey, start)
                yield Moment(
                    t, name, "note", f"your {noun} is here", title, start is not None, key=True, stray=True
                )
        if seen:
            last = max(_time(event, start) for event in part.of("interface"))
            for name in sorted(missing):
                yield Moment(last, name, "note", f"no {noun} of yours", title, start is not None, key=True)


def _missed(part: Part, reference: Reference, title: str, start: float | None) -> Iterator[Moment]:
    """Yield the reference solution's first messages that the subject did not send, if both had the same inputs.

    The time of a message is counted from the input before the message. If the task has no inputs, only intervals
    matter. The times are then counted from the subject's first message; if it sent none, from its first log line.
    """
    known = next(
        (one for one in reference.parts if one.name == part.name and one.inputs == part.inputs), None
    )
    if known is None or not _given_the_same(part, known):
        return
    inputs = [_time(event, start) for event in part.events if event.kind in _INPUTS]
    expected = [pair for pair in _after_inputs(known) if pair[1].sim is not None]
    for topic in dict.fromkeys(event.name for _, event, _ in expected):
        came = [(_time(event, start), label_of(event)) for event in part.of("message", topic)]
        due = [one for one in expected if one[1].name == topic]
        if len(due) < 2:
            continue  # no interval
        near = (due[1][1].moment - due[0][1].moment) / 2
        # The judge may have missed the subject's first messages. DDS numbers each publisher's messages from 1, so the
        # number of the first message that arrived shows how many are missing.
        number = int(part.of("message", topic)[0].data.get("number", 1)) if came else 1
        due = due[min(number, len(due)) - 1 :]
        first = came or [(_time(event, start), "") for event in part.of("log")]
        shift = (first[0][0] if first else 0.0) - due[0][1].moment
        said = [
            (inputs[given - 1] + after if given else event.moment + shift, label_of(event))
            for given, event, after in due
            if given <= len(inputs)
        ]
        missed = _not_come(said, came, near, carried=not inputs)
        for place, (t, label) in enumerate(missed[:EXPECTED]):
            yield Moment(
                round(t, 3), f"{topic}{ASKED}", "expected", label, title, start is not None, key=place == 0
            )


def _given_the_same(part: Part, known: Part) -> bool:
    """Return True if the subject got the inputs that the reference solution got. Random inputs may differ.

    If the subject ended early, only the inputs that it got before are compared.
    """
    mine, theirs = (
        [(e.kind, e.name, e.data.get("fields")) for e in one.events if e.kind in _INPUTS]
        for one in (part, known)
    )
    return all(one == other for one, other in zip(mine, theirs, strict=False))


def _after_inputs(known: Part) -> Iterator[tuple[int, Event, float]]:
    """Yield each message with the number of inputs before it, and the seconds since the last of these inputs."""
    given, last = 0, 0.0
    for event in known.events:
        if event.kind in _INPUTS:
            given, last = given + 1, event.moment
        elif event.kind == "message":
            yield given, event, event.moment - last


def _not_come(due: Sequence[_Said], came: Sequence[_Said], near: float, *, carried: bool) -> list[_Said]:
    """Return the expected messages that did not come, each with the time at which it was due.

    An expected message has come if a message with its label arrived at the right time, or at the right interval after
    the message before it. The interval is compared because a missing or superfluous message shifts all later ones.

    Args:
        due: Time and label of each message of the reference solution.
        came: Time and label of each message of the subject.
        near: Seconds by which a message may be early or late.
        carried: True if the subject sends by its own timer, so that a late message delays the next ones; False if each
            message answers an input, so that the input alone determines when it is due.
    """
    missed = []
    last, shift = -1, 0.0
    for place, (at, label) in enumerate(due):
        later = [k for k in range(last + 1, len(came)) if came[k][1] == label]
        found = next((k for k in later if abs(came[k][0] - at - shift) < near), None)
        # The first message of either list has no message before it, and so no interval to compare.
        if found is None and place and later and later[0]:
            after = came[later[0]][0] - came[later[0] - 1][0]
            found = later[0] if abs(after - (at - due[place - 1][0])) < near else None
        if found is None:
            missed.append((at + shift, label))
        else:
            last, shift = found, (came[found][0] - at) * carried
    return missed


_UNWRITTEN = "must return a LaunchDescription, not None"
"""What `ros2 launch` says of a launch file whose function returns nothing. Then each line is from the launch."""


def shows_nothing(evidence: Evidence) -> bool:
    """Return True if the subject sent, said and returned nothing, raised no error, and made no unexpected endpoint."""
    sent = {kind for kind, shown in KINDS.items() if shown.direction == HEARD} - {"log", "output"}
    asked = evidence.reference.interface
    return not any(
        part.traceback
        or (set(part.said()) - {"None"} and not any(line.endswith(_UNWRITTEN) for line in part.said()))
        or any(map(part.of, sent))
        or any(part.endpoints(role).items() - asked.get(role, {}).items() for role in _ENDS)
        for part in evidence
    )
