"""The verdict on one exercise, as plain data that can be sent as JSON.

All parts that show, store or count verdicts (cards, the gradebook, ``--json``) use these types. The types do not depend
on ROS, notebooks or the judge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

import msgspec


class State(StrEnum):
    """The result of a check. A failure of the judge is never a failure of the subject."""

    PASSED = "passed"
    """Every criterion is met."""
    FAILED = "failed"
    """The subject was checked, and at least one criterion is not met."""
    NOT_CHECKED = "not_checked"
    """The judge itself failed, for example because no ROS domain was free. This says nothing about the subject."""
    CHECKING = "checking"
    """The check goes on. Only the card that a student sees meanwhile has this state."""


@dataclass(frozen=True)
class CriterionResult:
    """A requirement of the exercise, and whether the subject met it.

    Attributes:
        name: The criterion's key, such as ``"rate"``, which does not change with the wording.
        title: A one-line name for people, such as ``"Publishes every 0.5 s"``.
        points: The points that the criterion is worth.
        passed: True if the criterion is met; None if this is not decided yet, while the check goes on.
        expected: What the reference solution does.
        seen: What the subject did.
        counts: What else is accepted, or is not judged, in one or two sentences; empty if there is nothing to say.
    """

    name: str
    title: str
    points: float
    passed: bool | None
    expected: str
    seen: str
    counts: str = ""


@dataclass(frozen=True)
class Diagnosis:
    """A known mistake that was recognized, with the next step for the student.

    Attributes:
        key: The mistake's key, such as ``"topic_name"`` (``docs/mistakes.md`` lists all keys).
        text: What happened and why, in one to three sentences for a student.
        next_step: What to do now, in the imperative.
        hidden: True if the card must not show the key, because finding the cause is the task.
    """

    key: str
    text: str
    next_step: str = ""
    hidden: bool = False


ASKS_FOR_INPUT = Diagnosis(
    "asks_for_input",
    "The code calls `input()`, and no person can answer `input()` while it is checked.",
    "Remove the line with `input()`, and write the value into the code instead. A program that needs a value takes "
    "it from `sys.argv`.",
)
"""The diagnosis for a cell, class or program that waits for keyboard input."""


@dataclass(frozen=True)
class Moment:
    """One dot on the timeline of a card.

    Attributes:
        t: Seconds since the judge began to watch, in simulated time if ``simulated`` is true.
        lane: The name of the topic, service or action; or ``"log"``.
        direction: ``"from_subject"``, ``"to_subject"`` or ``"note"``; ``"expected"`` for a message of the reference
            solution that did not come.
        label: A few words, such as the text, the numbers or the status.
        part: The name of the part, such as ``"the service is late"``; empty if the check has only one part.
        simulated: True if ``t`` is simulated time.
        key: True for an important event, such as a goal, a cancel request or a result. The timeline always labels it.
        stray: True for an endpoint that the task does not ask for.
    """

    t: float
    lane: str
    direction: str
    label: str
    part: str = ""
    simulated: bool = False
    key: bool = False
    stray: bool = False


Point = tuple[float, float]
"""A place in the plane, x and y in meters."""


@dataclass(frozen=True)
class Way:
    """The way of a robot through one world.

    Attributes:
        points: The places of the robot's center, in order. There is at least the start.
        heading: The heading at the end, in radians, counterclockwise from the x axis.
        walls: The two ends of each wall.
        places: Places with names, such as a lamp.
        bumps: The places at which the robot pushed against a wall.
        supposed: True if the subject uses a wrong name: only with the right one would a robot drive so.
    """

    points: tuple[Point, ...]
    heading: float = 0.0
    walls: tuple[tuple[Point, Point], ...] = ()
    places: dict[str, Point] = field(default_factory=dict)
    bumps: tuple[Point, ...] = ()
    supposed: bool = False

    @property
    def length(self) -> float:
        """The length of the way in meters."""
        return sum(math.dist(*pair) for pair in pairwise(self.points))


@dataclass(frozen=True)
class Verdict:
    """The judge's findings for one exercise.

    Attributes:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The title of the exercise that students read.
        state: Whether the check passed, failed, or could not be made.
        score: The points earned; 0 unless the subject was checked.
        max_score: The points available.
        criteria: The criteria in the order of the exercise; empty if nothing could be checked.
        diagnosis: The most helpful diagnosis; None if the check passed.
        remarks: Remarks that cost no points.
        timeline: The most important events on the wire, in order.
        ways: The ways of the robot, one for each world in which it was driven.
        seed: The seed of the random inputs; the same seed gives the same inputs.
        seconds: The duration of the check, in seconds of wall time.
        detail: A traceback, or the last lines of output, if they help; else empty.
        counts: What else counts for the exercise as a whole, and what is not graded; empty if there is nothing to say.
        nothing_seen: True if nothing of the subject was seen, not even an error, as before its first line is written.
    """

    exercise: str
    title: str
    state: State
    score: float
    max_score: float
    criteria: tuple[CriterionResult, ...] = ()
    diagnosis: Diagnosis | None = None
    remarks: tuple[str, ...] = ()
    timeline: tuple[Moment, ...] = ()
    ways: tuple[Way, ...] = ()
    seed: str = ""
    seconds: float = 0.0
    detail: str = ""
    counts: str = ""
    nothing_seen: bool = False

    @property
    def passed(self) -> bool:
        """True if every criterion is met."""
        return self.state is State.PASSED


def to_json(verdict: Verdict) -> bytes:
    """Return the verdict as one line of UTF-8 JSON."""
    return msgspec.json.encode(verdict)


def from_json(data: bytes | str) -> Verdict:
    """Return the verdict that JSON contains.

    Raises:
        msgspec.ValidationError: ``data`` is JSON but not a verdict.
        msgspec.DecodeError: ``data`` is not JSON.
    """
    return msgspec.json.decode(data, type=Verdict)


def failed(exercise: str, title: str, max_score: float, diagnosis: Diagnosis, detail: str = "") -> Verdict:
    """Return a failed verdict with zero points, for a submission that cannot be checked because of its own mistake."""
    return Verdict(exercise, title, State.FAILED, 0.0, max_score, diagnosis=diagnosis, detail=detail)


NO_RESULT = "not_checked"
"""The key of the diagnosis of a check that has no result because the grader failed, which is not a student's fault."""


def not_checked(
    exercise: str, title: str, max_score: float, reason: str, next_step: str = "", key: str = NO_RESULT
) -> Verdict:
    """Return a verdict with the state ``not_checked``.

    Args:
        exercise: The exercise's id.
        title: The exercise's title.
        max_score: The exercise's points.
        reason: Why there is no result. If ``next_step`` is not given, the second line of the reason is the next step.
        next_step: What the student should do.
        key: The key of the diagnosis. Only with the usual one does the card say that the checker had trouble.
    """
    if not next_step:
        reason, _, next_step = reason.partition("\n")
    return Verdict(
        exercise=exercise,
        title=title,
        state=State.NOT_CHECKED,
        score=0.0,
        max_score=max_score,
        diagnosis=Diagnosis(key=key, text=reason, next_step=next_step),
    )
