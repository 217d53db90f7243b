"""Judges a check again from its evidence, with the current code of the exercise."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.command_name import COMMAND
from autograder.judge import evidence_files
from autograder.judge.evidence_files import NoEvidence, evidence_of
from autograder.judge.verdicts import deciding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.judge.evidence_files import Kept
    from autograder.verdict import Verdict


class CannotReplay(ValueError):
    """The check cannot be judged again. The message says why, and what to do."""


@dataclass(frozen=True)
class Replay:
    """The result of judging a check a second time.

    Attributes:
        then: The earlier verdict, from when the check was made.
        now: The new verdict, from the current code.
        differences: One line for each important difference: state, points, criteria, diagnosis.
        notes: Possible reasons for differences, and differences that are only in the wording.
    """

    then: Verdict
    now: Verdict
    differences: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def replay(kept: Kept) -> Replay:
    """Judge a check again from its evidence, and compare the new verdict with the earlier one.

    Raises:
        CannotReplay: The exercise no longer exists, or the evidence is not sufficient.
    """
    then = kept.verdict
    if kept.cut:
        raise CannotReplay(
            f"the evidence of this check was too long and is incomplete, so no verdict follows from it: {kept.cut}. "
            f"`{COMMAND} grade --student STUDENT --again` repeats the check with the same inputs."
        )
    try:
        exercise = exercises.get(then.exercise)
        expected = evidence_files.load_reference(exercise.id)
        changed = evidence_files.reference_digest(exercise.id) != kept.reference
    except (exercises.UnknownExercise, exercises.BrokenExercise, evidence_files.NoReference) as error:
        raise CannotReplay(f"{error} Use the version of the course that the check was made with.") from error
    try:
        now = deciding.decide(exercise, evidence_of(kept, expected), then.seed)
    except NoEvidence as error:
        raise CannotReplay(f"{error} in this check, so there is nothing to judge again") from error
    except Exception as error:  # evidence from another version, or written by hand, may lack any field
        raise CannotReplay(
            f"{exercise.id} cannot be decided from this evidence ({type(error).__name__}: {error}). Either it was "
            "edited, or it comes from another version of the course: then use that version."
        ) from error
    notes = ["the reference output of this exercise has changed since then"] if changed else []
    return Replay(then, now, list(_differences(then, now)), notes + list(_other_words(then, now)))


def _differences(then: Verdict, now: Verdict) -> Iterator[str]:
    if then.state != now.state:
        yield f"state: was {then.state}, is {now.state}"
    if (then.score, then.max_score) != (now.score, now.max_score):
        yield f"points: was {_points(then)}, is {_points(now)}"
    before = {criterion.name: criterion for criterion in then.criteria}
    after = {criterion.name: criterion for criterion in now.criteria}
    for name in dict.fromkeys((*before, *after)):
        old, new = before.get(name), after.get(name)
        if old is None or new is None:
            yield f"criterion {name}: {'it is new' if old is None else 'it no longer exists'}"
        elif (old.passed, old.points) != (new.passed, new.points):
            yield f"criterion {name}: was {_held(old.passed, old.points)}, is {_held(new.passed, new.points)}"
    if _key(then) != _key(now):
        yield f"diagnosis: was {_key(then) or 'none'}, is {_key(now) or 'none'}"


def _other_words(then: Verdict, now: Verdict) -> Iterator[str]:
    """Yield differences in the wording that students read. They change no grade."""
    before = {criterion.name: criterion for criterion in then.criteria}
    for new in now.criteria:
        old = before.get(new.name)
        if old is not None and (old.expected, old.seen) != (new.expected, new.seen):
            yield f"criterion {new.name} is worded differently now: {_quoted(new.expected)}, {_quoted(new.seen)}"
    if then.diagnosis and now.diagnosis and _key(then) == _key(now) and then.diagnosis != now.diagnosis:
        yield f"the diagnosis is worded differently now: {_quoted(now.diagnosis.text)}"


def _points(verdict: Verdict) -> str:
    return f"{verdict.score:g} of {verdict.max_score:g}"


def _held(passed: bool | None, points: float) -> str:
    return f"{'met' if passed else 'not met'} ({points:g} points)"


def _key(verdict: Verdict) -> str:
    return verdict.diagnosis.key if verdict.diagnosis else ""


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
