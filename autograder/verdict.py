"""The verdict on one exercise, as plain data that travels as JSON.

Everything that shows, stores or counts a verdict (cards, the gradebook, ``--json``) reads these types. They
know nothing of ROS, of notebooks or of how the judge came to its findings.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import msgspec


class State(StrEnum):
    """The end of a check: three different things that are never mixed up."""

    PASSED = "passed"
    """Every criterion holds."""
    FAILED = "failed"
    """The subject was checked and at least one criterion does not hold."""
    NOT_CHECKED = "not_checked"
    """The judge itself had trouble (no ROS, no free domain, a judge that died). Says nothing of the subject."""


@dataclass(frozen=True)
class Criterion:
    """One thing that was asked for, and whether it was seen.

    Attributes:
        name: A stable key such as ``"rate"``.
        title: One line for a person, such as ``"Publishes every 0.5 s"``.
        points: Points that this criterion carries.
        passed: Whether it holds.
        expected: What the reference solution does.
        seen: What the subject did.
    """

    name: str
    title: str
    points: float
    passed: bool
    expected: str
    seen: str


@dataclass(frozen=True)
class Diagnosis:
    """A known mistake, and what to do next.

    Attributes:
        key: The mistake's stable name, such as ``"topic_name"`` (``docs/mistakes.md`` lists them).
        text: What happened and why, in one to three sentences for a student.
        next_step: What to do now, in the imperative.
    """

    key: str
    text: str
    next_step: str = ""


ASKS_FOR_INPUT = Diagnosis(
    "asks_for_input",
    "The code calls `input()`, and nobody can answer `input()` while it is checked.",
    "Remove the line with `input()`, and write the value into the code instead. A program that needs a value takes "
    "it from `sys.argv`.",
)
"""The same words for a cell, a class and a program that wait for someone to type."""


@dataclass(frozen=True)
class Moment:
    """One dot on the card's timeline.

    Attributes:
        t: Seconds since the check began to watch (simulated seconds where ``simulated`` is set).
        lane: Where it happened: a topic, service or action name, or ``"log"``.
        direction: ``"from_subject"``, ``"to_subject"`` or ``"note"``; ``"expected"`` for what did not happen: a
            message of the reference solution's that did not come.
        label: A few words: the text, the numbers, the status.
        part: Which part of the check, where it has several (``"the service is late"``), else empty.
        simulated: Whether ``t`` is simulated time.
        key: Whether the story hangs on it, such as a goal, a cancel request, a result: a picture always names it.
        stray: Whether it was beside the point, such as on a topic that nobody asked for.
    """

    t: float
    lane: str
    direction: str
    label: str
    part: str = ""
    simulated: bool = False
    key: bool = False
    stray: bool = False


@dataclass(frozen=True)
class Verdict:
    """The judge's findings for one exercise.

    Attributes:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The exercise's name for a person.
        state: Passed, failed or not checked.
        score: Points earned; 0 unless the subject was checked.
        max_score: Points that can be earned.
        criteria: In the order of the exercise; empty when nothing could be checked.
        diagnosis: The most useful known mistake, or None when all is well.
        remarks: Things worth a word that cost no points.
        timeline: What was on the wire, in order, capped in number.
        seed: What the random inputs were drawn from; the same seed gives the same inputs.
        seconds: Wall time that the check took.
        detail: A traceback or the last lines of output, where they help; empty otherwise.
    """

    exercise: str
    title: str
    state: State
    score: float
    max_score: float
    criteria: tuple[Criterion, ...] = ()
    diagnosis: Diagnosis | None = None
    remarks: tuple[str, ...] = ()
    timeline: tuple[Moment, ...] = ()
    seed: str = ""
    seconds: float = 0.0
    detail: str = ""

    @property
    def passed(self) -> bool:
        """True if every criterion holds."""
        return self.state is State.PASSED


def to_json(verdict: Verdict) -> bytes:
    """The verdict as one line of UTF-8 JSON."""
    return msgspec.json.encode(verdict)


def from_json(data: bytes | str) -> Verdict:
    """Read a verdict back.

    Raises:
        msgspec.ValidationError: ``data`` is JSON but not a verdict.
        msgspec.DecodeError: ``data`` is not JSON.
    """
    return msgspec.json.decode(data, type=Verdict)


def failed(exercise: str, title: str, max_score: float, diagnosis: Diagnosis, detail: str = "") -> Verdict:
    """The verdict for a check that could not be made because of what was submitted; it earns nothing."""
    return Verdict(
        exercise=exercise,
        title=title,
        state=State.FAILED,
        score=0.0,
        max_score=max_score,
        diagnosis=diagnosis,
        detail=detail,
    )


def not_checked(exercise: str, title: str, max_score: float, reason: str, next_step: str = "") -> Verdict:
    """Return the verdict for trouble of the grader's own; it earns nothing and accuses nobody.

    A reason of two lines has what to do in its second line, if ``next_step`` is not given.
    """
    if not next_step:
        reason, _, next_step = reason.partition("\n")
    return Verdict(
        exercise=exercise,
        title=title,
        state=State.NOT_CHECKED,
        score=0.0,
        max_score=max_score,
        diagnosis=Diagnosis(key="not_checked", text=reason, next_step=next_step),
    )
