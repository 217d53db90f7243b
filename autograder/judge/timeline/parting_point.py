"""Finds where a subject's run leaves the reference solution's, for a failure that no known mistake explains.

A *turn* is what the subject does after one question of the judge, such as a goal with its feedback and result, or what
it does on one service or action if it asks itself. What is compared is which kinds of events a turn has, and how many.
Values may have been drawn differently, threads may change the order, and the criteria allow for more than one value.
Messages on a topic are compared by the timeline, which knows when each was due.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.judge.timeline import verdict_timeline

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Event, Evidence, Part

_QUESTIONS = ("goal_sent", "asked")
_DONE = {
    "goal_answer": ("answer to the goal", "the goal is {}"),
    "feedback_heard": ("feedback", "feedback {}"),
    "cancel_answer": ("answer to the cancel request", "your server {}"),
    "result_heard": ("result", "the result {}"),
    "answered": ("answer", "the answer {}"),
    "request": ("request", "a request with {}"),
    "goal": ("goal", "a {}"),
    "cancel": ("cancel request", "a cancel request"),
    "result_request": ("request for the result", "a request for the result"),
}
"""What the subject does, by kinds of events, in the usual order: a noun, and words for one event."""
_LONGEST = 60
"""The maximum length of a label in the sentence, in characters."""
_FEW = 2
"""If at most this many messages came on a topic, the judge surely listened for more of them."""


@dataclass(frozen=True)
class _Turn:
    """A turn: the part and lane in which it happens, the question of the judge (empty if the subject asks), and events.

    ``is_cut`` is True if a cancel request decides how much is done.
    """

    part: str
    lane: str
    question: str
    done: Sequence[Event]
    is_cut: bool


def parting_point(evidence: Evidence) -> str:
    """Return in a sentence where the run leaves the reference solution's; empty if it does the same kinds of things."""
    known = [turn for part in evidence.reference.parts for turn in _turns(part)]
    for part in evidence:
        for turn in _turns(part):
            alike = [
                one
                for one in known
                if (one.part, one.lane, one.is_cut) == (turn.part, turn.lane, turn.is_cut)
            ]
            same = [
                one for one in alike if turn.question and one.question == turn.question and not turn.is_cut
            ]
            told = [_difference(turn, model, counted=bool(same)) for model in same or alike]
            if told and all(told):
                return told[0]
    return _on_a_topic(evidence)


def _turns(part: Part) -> Iterator[_Turn]:
    """Yield the turns of a part, lane by lane."""
    shown = [
        event for event in part.events if event.kind in verdict_timeline.KINDS and event.kind != "subject"
    ]
    turns: dict[str, list[list[Event]]] = {}
    for lane, event in zip(verdict_timeline.lane_names(shown), shown, strict=True):
        of_lane = turns.setdefault(lane, [])
        if not of_lane or event.kind in _QUESTIONS:
            of_lane.append([])
        of_lane[-1].append(event)
    for events in (events for lists in turns.values() for events in lists):
        question = verdict_timeline.label_of(events[0]) if events[0].kind in _QUESTIONS else ""
        done = [event for event in events if event.kind in _DONE]
        if done or question:
            is_cut = any(event.kind in ("cancel_sent", "cancel") for event in events)
            yield _Turn(part.name, events[0].name, question, done, is_cut)


def _difference(turn: _Turn, model: _Turn, *, counted: bool) -> str:
    """Return where a turn leaves the reference solution's, in a sentence; empty if it does not.

    Args:
        turn: The subject's turn.
        model: The reference solution's.
        counted: True to compare how often each thing is done, False to compare only what is never done.
    """
    before = turn.question
    for kind, (noun, _) in _DONE.items():
        came, due = ([event for event in one.done if event.kind == kind] for one in (turn, model))
        outcomes = [[_outcome(event) for event in events] for events in (came, due)]
        if outcomes[0] != outcomes[1] if counted else set(outcomes[1]) - set(outcomes[0]):
            alike = next(
                (i for i, (a, b) in enumerate(zip(*outcomes, strict=False)) if a != b),
                min(map(len, outcomes)),
            )
            # Name the last event that was as asked, so that the student finds the place in the run.
            before = _words(came[alike - 1]) if alike else before
            nothing = f"no {'more ' * bool(alike)}{noun}"
            then = _words(came[alike]) if alike < len(came) else nothing
            asked = _words(due[alike]) if alike < len(due) else nothing
            until = f", until {before}" if before else ""
            return f"On {turn.lane}{until}, your run is as asked. Then: {then}. Asked: {asked}."
        before = _words(came[-1]) if came else before
    return ""


def _outcome(event: Event) -> object:
    """Return what has to be equal of two events of a kind: a status, or whether something was accepted."""
    if event.kind == "result_heard":
        return event.data["status"]
    return event.data["accepted"] if event.kind in ("goal_answer", "cancel_answer") else None


def _words(event: Event) -> str:
    label = verdict_timeline.label_of(event)
    return _DONE[event.kind][1].format(label if len(label) <= _LONGEST else f"{label[:_LONGEST]}…")


def _on_a_topic(evidence: Evidence) -> str:
    """Return the first message that did not come when it was due, in a sentence; empty if it is unclear."""
    moments = verdict_timeline.moments(evidence, missed=True)
    due = next((moment for moment in moments if moment.direction == "expected"), None)
    if due is None:
        return ""
    topic = due.lane.removesuffix(verdict_timeline.ASKED)
    mine = [
        one for one in moments if (one.lane, one.part, one.direction) == (topic, due.part, "from_subject")
    ]
    before = [one for one in mine if one.t < due.t]
    unlike = [one for one in mine if one.t >= due.t][:1]
    if not unlike[0].key if unlike else len(mine) > _FEW:
        return ""
    until = f", until “{before[-1].label}”, your run is as asked. Then" if before else ""
    came = f"“{unlike[0].label}”" if unlike else "no message" if not before else "no more messages"
    when = f", {due.t - before[-1].t:.1f} s later" if before else ""
    return f"On {topic}{until}: {came}. Asked: “{due.label}”{when}."
