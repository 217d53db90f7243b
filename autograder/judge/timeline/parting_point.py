"""Finds the step at which a run leaves the reference solution's, for a failure that no known mistake explains.

A *turn* is what the subject does after one question of the judge, such as a goal with its feedback and result, or what
it does on one service or action if it asks itself. What is compared is which kinds of events a turn has, and how many.
Values may have been drawn differently, threads may change the order, and the criteria allow for more than one value.
Messages on a topic are compared by the timeline, which knows when each was due.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.judge.timeline import event_kinds, verdict_timeline
from autograder.kit.evidence import Event
from autograder.messages.judge_messages import OwnLine

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Evidence, Part

_QUESTIONS = ("goal_sent", "asked")
_DONE = {
    "goal_answer": ("answer to the goal", "the goal is {}", ("GoalResponse",)),
    "feedback_heard": ("feedback", "feedback {}", ("publish_feedback",)),
    "cancel_answer": ("answer to the cancel request", "your server {}", ("CancelResponse",)),
    "result_heard": ("result", "the result {}", ("succeed",)),
    "answered": ("answer", "the answer {}", ("create_service",)),
    "request": ("request", "a request with {}", ("call", "call_async")),
    "goal": ("goal", "a {}", ("send_goal", "send_goal_async")),
    "cancel": ("cancel request", "a cancel request", ("cancel_goal", "cancel_goal_async")),
    "result_request": (
        "request for the result",
        "a request for the result",
        ("get_result", "get_result_async"),
    ),
}
"""The deeds of a subject, by kinds of events, in the usual order: a noun, words for one event, and the methods or
classes of rclpy with which a program does it, the usual one last.
"""
_ENDS = {4: "succeed", 5: "canceled", 6: "abort"}
"""The methods that end a goal, by the status of its result."""
_LONGEST = 60
"""The maximum length of a label in the sentence, in characters."""
OWN_LINE = "own_line"
"""The kind of the events that contain a claimed line of the student's code."""
SHOWN_LINES = 2
"""The maximum number of lines that a card shows for one cause."""
LONGEST_LINE = 120
"""The maximum length of a quoted line, in characters."""
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


@dataclass(frozen=True)
class PartingPoint:
    """The point at which a run leaves the reference solution's.

    Attributes:
        text: The place in the run, and the difference, in a sentence.
        causes: The methods or classes of rclpy that cause such an event, each after others that do the same.
    """

    text: str
    causes: Sequence[Sequence[str]]


def claimed(causes: Sequence[Sequence[str]], lines: Sequence[OwnLine]) -> list[Event]:
    """Return the lines of the student's code that use the causes, as events; one with number 0 if no line does.

    If more lines than a card shows use a cause, there is no event: the card cannot say which of them it is.
    """
    places = {line.place for line in lines}
    where = places.pop() if len(places) == 1 else "your code"
    return [
        Event(0.0, OWN_LINE, names[-1], _quoted(line))
        for names in causes
        for line in _few(_lines_of(names, lines) or _absent(names[-1], where))
    ]


def _absent(name: str, where: str) -> list[OwnLine]:
    # A definition or an assignment has a blank in its name. It may be elsewhere, and then there is nothing to say.
    return [] if " " in name else [OwnLine(name, where, 0, "")]


def _lines_of(names: Sequence[str], lines: Sequence[OwnLine]) -> list[OwnLine]:
    using = ([line for line in lines if line.name == name] for name in names)
    return next(filter(None, using), [])


def _few(lines: list[OwnLine]) -> list[OwnLine]:
    return lines if len(lines) <= SHOWN_LINES else []


def _quoted(line: OwnLine) -> dict[str, Any]:
    # The text comes from a process that the student controls, and backticks would end the quotation.
    place, text = (one.replace("`", "'")[:LONGEST_LINE] for one in (line.place, line.text))
    return {"place": place, "number": line.number, "text": text}


def own_lines_in_words(evidence: Evidence) -> str:
    """Return the claimed lines of the student's code in sentences; empty if no line was claimed."""
    return " ".join(
        "Line {number} of {place}: `{text}`.".format(**line.data)
        if line.data["number"]
        else "No line of {place} uses `{name}`.".format(name=line.name, **line.data)
        for part in evidence
        for line in part.of(OWN_LINE)
    )


def parting_point(evidence: Evidence) -> PartingPoint | None:
    """Return the point at which the run leaves the reference solution's; None if it does the same kinds of things."""
    known = [turn for part in evidence.reference.parts for turn in _turns(part)]
    for part in evidence:
        for turn in _turns(part):
            place, question = (turn.part, turn.lane, turn.is_cut), "" if turn.is_cut else turn.question
            alike = [one for one in known if (one.part, one.lane, one.is_cut) == place]
            same = [one for one in alike if question and one.question == question]
            told = [_difference(turn, model, counted=bool(same)) for model in same or alike]
            if told and all(told):
                return told[0]
    return _on_a_topic(evidence)


def _turns(part: Part) -> Iterator[_Turn]:
    """Yield the turns of a part, lane by lane."""
    shown = [event for event in part.events if event.kind in event_kinds.KINDS and event.kind != "subject"]
    turns: dict[str, list[list[Event]]] = {}
    for lane, event in zip(verdict_timeline.lane_names(shown), shown, strict=True):
        of_lane = turns.setdefault(lane, [])
        if not of_lane or event.kind in _QUESTIONS:
            of_lane.append([])
        of_lane[-1].append(event)
    for events in (events for lists in turns.values() for events in lists):
        question = event_kinds.label_of(events[0]) if events[0].kind in _QUESTIONS else ""
        done = [event for event in events if event.kind in _DONE]
        if done or question:
            is_cut = any(event.kind in ("cancel_sent", "cancel") for event in events)
            yield _Turn(part.name, events[0].name, question, done, is_cut)


def _difference(turn: _Turn, model: _Turn, *, counted: bool) -> PartingPoint | None:
    """Return the point at which a turn leaves the reference solution's; None if it does not.

    Args:
        turn: The subject's turn.
        model: The reference solution's.
        counted: True to compare how often each thing is done, False to compare only what is never done.
    """
    before = turn.question
    for kind, (noun, _, causes) in _DONE.items():
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
            text = f"On {turn.lane}{until}, your run is as asked. Then: {then}. Asked: {asked}."
            if kind == "result_heard":
                ends = (*came[alike : alike + 1], *due[alike : alike + 1])
                causes = tuple(_ENDS[end.data["status"]] for end in ends if end.data["status"] in _ENDS)
            return PartingPoint(text, [causes])
        before = _words(came[-1]) if came else before
    return None


def _outcome(event: Event) -> object:
    """Return what has to be equal of two events of a kind: a status, or whether something was accepted."""
    if event.kind == "result_heard":
        return event.data["status"]
    return event.data["accepted"] if event.kind in ("goal_answer", "cancel_answer") else None


def _words(event: Event) -> str:
    label = event_kinds.label_of(event)
    return _DONE[event.kind][1].format(label if len(label) <= _LONGEST else f"{label[:_LONGEST]}…")


def _on_a_topic(evidence: Evidence) -> PartingPoint | None:
    """Return the first message that did not come when it was due; None if it is unclear."""
    moments = verdict_timeline.moments(evidence, missed=True)
    due = next((moment for moment in moments if moment.direction == "expected"), None)
    if due is None:
        return None
    topic = due.lane.removesuffix(verdict_timeline.ASKED)
    mine = [
        one for one in moments if (one.lane, one.part, one.direction) == (topic, due.part, "from_subject")
    ]
    before = [one for one in mine if one.t < due.t]
    unlike = [one for one in mine if one.t >= due.t][:1]
    if not unlike[0].key if unlike else len(mine) > _FEW:
        return None
    until = f", until “{before[-1].label}”, your run is as asked. Then" if before else ""
    came = f"“{unlike[0].label}”" if unlike else "no message" if not before else "no more messages"
    when = f", {due.t - before[-1].t:.1f} s later" if before else ""
    # A message with another text came from a line that publishes. One that is missing may be a matter of the timer.
    answers = any(moment.direction == "to_subject" for moment in moments)
    causes = [("publish",)] if unlike or answers else [("create_timer",), ("publish",)]
    return PartingPoint(f"On {topic}{until}: {came}. Asked: “{due.label}”{when}.", causes)
