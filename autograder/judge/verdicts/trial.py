"""One check from beginning to end: look, judge, look again where that is fair, say what is wrong."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import partial
from random import Random
from typing import TYPE_CHECKING

from autograder.judge.bench.bench import TestBench
from autograder.judge.verdicts import timeline
from autograder.judge.verdicts.crowding import SEEN_SO_FAR, TOO_BUSY, Crowding, Hurry, OutOfTime, TooBusy
from autograder.judge.verdicts.deciding import Undecided, limited, undecidable
from autograder.judge.verdicts.delivery import NOT_DELIVERED, NotDelivered, delivers
from autograder.kit.evidence import Evidence, Reference
from autograder.kit.in_words import of_its_kind, shortened
from autograder.kit.model import Advice, Exercise, Mistake, Pace
from autograder.verdict import Criterion, Diagnosis, State, Verdict

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.subjects.subject import Subject

UNKNOWN = "unknown"
"""The key of the diagnosis of a mistake that has no name."""
MAX_DETAIL = 6_000
"""Characters of a traceback that a card shows."""
MAX_WORDS = 500
"""Characters of one sentence of a verdict; what a subject said is quoted in them."""


@dataclass(frozen=True)
class Seen:
    """The result of one look.

    Attributes:
        evidence: What happened.
        doubtful: Whether even a pass must be confirmed in real time.
        unmet: Whether a run began before the subject's participant had met what the judge put up, as far as it says.
    """

    evidence: Evidence
    doubtful: bool
    unmet: bool = False


@dataclass(frozen=True)
class Checked:
    """The result of a check.

    Attributes:
        verdict: What the judge found.
        evidence: What that follows from.
        crowded: It did not pass, nothing proves a mistake, and the machine was more crowded in a look in real time than
            the judge's limits allow for, or the subject had not met what the judge put up.
    """

    verdict: Verdict
    evidence: Evidence
    crowded: bool = False


def check(
    exercise: Exercise,
    subject: Subject,
    reference: Reference,
    *,
    seed: str,
    domain_id: int,
    marks_crowded: bool = False,
) -> Checked:
    """Judge a subject.

    A fast pass counts; what fails fast is looked at again in real time, unless the evidence proves the failure whatever
    the machine's load is. What cannot be decided within :data:`autograder.judge.verdicts.deciding.LIMIT` has failed.

    Args:
        exercise: What is asked for.
        subject: What is judged.
        reference: What the reference solution did.
        seed: What random inputs are drawn from.
        domain_id: The ROS domain.
        marks_crowded: Give the verdict all the same, marked, where the machine was too crowded to tell.

    Raises:
        TooBusy: It was, and nobody wants a marked verdict; or a student has waited for long on a busy machine.
        NotDelivered: It did not pass, nothing proves a mistake, and this machine lost messages before or after.
    """
    began = time.monotonic()
    crowded, delivered = False, delivers()
    # A student waits in front of a cell. A grader does not, and a program may be built first.
    hurry = Hurry() if subject.shares_participant and not marks_crowded else _no_hurry
    subject.begin(domain_id)
    look_at = partial(look, exercise, subject, reference, seed=seed, domain_id=domain_id, hurry=hurry)
    try:
        seen = look_at(Pace.FAST)
    except OutOfTime:
        raise TooBusy(TOO_BUSY) from None
    evidence = seen.evidence
    try:
        with limited():
            verdict = judge(exercise, evidence, seed)
            again = exercise.second_look and (seen.doubtful or not verdict.passed)
            again = again and not is_certain(exercise, evidence)
        if again:
            if not marks_crowded:  # a submission must not hear how its check goes
                subject.tell_so_far(_so_far(verdict))
            try:
                with Crowding() as crowding:
                    seen = look_at(Pace.REAL_TIME, before=evidence)
            except OutOfTime:
                raise TooBusy(f"{TOO_BUSY} {_so_far(verdict)}".strip()) from None
            evidence = replace(seen.evidence, before=evidence)
            with limited():
                verdict = judge(exercise, evidence, seed)
        if (seen.unmet or (again and crowding.too_busy)) and not verdict.passed:
            with limited():
                crowded = not is_certain(exercise, evidence)
        if not verdict.passed and not (delivered and delivers()):
            with limited():
                certain = is_certain(exercise, evidence)
            if not certain:
                raise NotDelivered(NOT_DELIVERED)
    except Undecided:
        verdict = undecidable(exercise, seed)
    if crowded and not marks_crowded:
        raise TooBusy(f"{TOO_BUSY} {_so_far(verdict)}".strip())
    return Checked(replace(verdict, seconds=round(time.monotonic() - began, 3)), evidence, crowded)


def _no_hurry() -> None:
    """Let a check take its time."""


def _so_far(verdict: Verdict) -> str:
    """The diagnosis of a failed look as a sentence that claims nothing for sure; empty if the mistake is unknown."""
    known = verdict.diagnosis
    return SEEN_SO_FAR.format(known.text) if known and known.key != UNKNOWN else ""


def decide(exercise: Exercise, evidence: Evidence, seed: str) -> Verdict:
    """The verdict that follows from evidence that is there already, within the judge's limit."""
    try:
        with limited():
            return judge(exercise, evidence, seed)
    except Undecided:
        return undecidable(exercise, seed)


def look(
    exercise: Exercise,
    subject: Subject,
    reference: Reference,
    pace: Pace,
    *,
    seed: str,
    domain_id: int,
    before: Evidence | None = None,
    hurry: Callable[[], None] = _no_hurry,
) -> Seen:
    """Run the scenario once and return what was seen.

    Args:
        exercise: What is asked for.
        subject: What is judged.
        reference: What the reference solution did.
        pace: Of this look.
        seed: What random inputs are drawn from.
        domain_id: The ROS domain.
        before: What the first look saw.
        hurry: Called repeatedly while the judge waits; it may end the look by raising an exception.
    """
    bench = TestBench(subject, domain_id, reference, pace, Random(seed), before, hurry)
    try:
        exercise.scenario(bench)
    finally:
        bench.close()
    # A scenario may draw the order of its parts; what is said of them must not depend on it.
    places = {part.name: place for place, part in enumerate(reference.parts)}
    parts = sorted(bench.parts, key=lambda part: places.get(part.name, len(places)))
    return Seen(Evidence(parts, reference, pace is Pace.REAL_TIME), bench.doubtful, bench.unmet)


def judge(exercise: Exercise, evidence: Evidence, seed: str) -> Verdict:
    """The verdict that follows from the evidence alone."""
    criteria = tuple(
        Criterion(c.name, c.title, c.points, finding.passed, _cut(finding.expected), _cut(finding.seen))
        for c in exercise.criteria
        for finding in [c.judge(evidence)]
    )
    passed = all(criterion.passed for criterion in criteria)
    diagnosis, traceback = (None, "") if passed else diagnose(exercise, evidence)
    told = (diagnosis.text if diagnosis else "", *(one.seen for one in criteria if not one.passed))
    return Verdict(
        exercise=exercise.id,
        title=exercise.title,
        state=State.PASSED if passed else State.FAILED,
        score=float(sum(c.points for c in criteria if c.passed)),
        max_score=float(exercise.points),
        criteria=criteria,
        diagnosis=diagnosis,
        remarks=tuple(_cut(text) for remark in exercise.remarks if (text := remark(evidence))),
        timeline=timeline.moments(evidence, " ".join(told), missed=not passed),
        seed=seed,
        detail=traceback[-MAX_DETAIL:],
    )


def diagnose(exercise: Exercise, evidence: Evidence) -> tuple[Diagnosis, str]:
    """The first known mistake that the evidence shows, and the traceback that it was told from, where it was.

    No other traceback is shown beside it: that of another run, perhaps of a line that is right, would be taken for the
    mistake.
    """
    found = _recognised(exercise, evidence)
    if found is not None:
        mistake, advice = found
        in_a_notebook = evidence.in_a_notebook
        text, next_step = (
            _cut(of_its_kind(shortened(words), in_a_notebook), 2 * MAX_WORDS)
            for words in (advice.text, advice.next_step)
        )
        return Diagnosis(mistake.key, text, next_step), advice.traceback
    unknown = Diagnosis(
        UNKNOWN,
        "This is none of the mistakes that the judge knows by name.",
        "Compare what was expected with what was seen, criterion by criterion.",
    )
    return unknown, ""


def _recognised(exercise: Exercise, evidence: Evidence) -> tuple[Mistake, Advice] | None:
    for mistake in exercise.mistakes:
        advice = mistake.recognise(evidence)
        if advice is not None:
            return mistake, advice
    return None


def is_certain(exercise: Exercise, evidence: Evidence) -> bool:
    """True if the evidence proves a mistake whatever the machine's load was."""
    found = _recognised(exercise, evidence)
    return found is not None and found[0].certain


def _cut(text: str, limit: int = MAX_WORDS) -> str:
    """A sentence that fits on a card, whatever a subject has said in it."""
    return text if len(text) <= limit else f"{text[: limit - 1]}…"
