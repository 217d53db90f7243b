"""Runs one check: a list of looks, each with its evidence and what it decided. The last one is the result."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from random import Random
from typing import TYPE_CHECKING

from autograder.judge.bench.bench import Confirmed, TestBench
from autograder.judge.bench.subject_time import Unanswered
from autograder.judge.machine_fitness import (
    NOT_DELIVERED,
    SEEN_SO_FAR,
    TOO_BUSY,
    Crowding,
    Hurry,
    JudgeFailed,
    NotDelivered,
    OutOfTime,
    TooBusy,
    delivers,
)
from autograder.judge.timeline.growing_card import GrowingCard
from autograder.judge.verdicts.deciding import (
    criterion_result,
    decide,
    endless_loop,
    is_certain,
    is_readable,
    misnamed,
    with_own_lines,
)
from autograder.judge.verdicts.exercise_faults import of_exercise
from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.model import UNKNOWN, Exercise
from autograder.kit.output.workspace_reports import runner_trouble

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from autograder.judge.subject import Subject
    from autograder.verdict import Verdict


CUT = (
    "The machine is busy, so the judge did not look again. After you have corrected what the card names, more criteria "
    "may be met than it seems now."
)
"""A remark on a check that a busy machine has cut after a look that proves a mistake."""

Names = Mapping[str, Mapping[str, str]]
NO_NAMES: Names = {}


@dataclass(frozen=True)
class Seen:
    """The result of one look.

    Attributes:
        evidence: The recorded events.
        doubtful: True if even a pass must be confirmed in real time; of a look in real time, True if a busy machine may
            be why it confirms the first one.
        unmet: True if a run began before the subject's participant had discovered the judge's endpoints.
        confirms: True if this look in real time went as the first one, whose evidence decides.
    """

    evidence: Evidence
    doubtful: bool
    unmet: bool = False
    confirms: bool = False


@dataclass(frozen=True)
class Look:
    """A look, and what it decided. The last look of a check is the result of the check.

    Attributes:
        seen: What the judge saw in it.
        evidence: The evidence from which the verdict was derived: what was seen in this look, and before.
        verdict: The verdict.
        names: The wrong names of the subject that the judge used in it, as :func:`misnamed` returns them.
        crowded: True if the verdict is not a pass and may be unfair: nothing proves a mistake, and either the machine
            was too busy in this look in real time, or the subject had not discovered the judge's endpoints.
    """

    seen: Seen
    evidence: Evidence
    verdict: Verdict
    names: Names
    crowded: bool = False


def check(
    exercise: Exercise,
    subject: Subject,
    reference: Reference,
    *,
    seed: str,
    domain_id: int,
    marks_crowded: bool = False,
    practice: Reference | None = None,
) -> Look:
    """Judge a subject in one look, or in two looks if the first does not decide.

    A subject that passes the first look, in simulated time, has passed. If it fails, a second look in real time
    decides, unless the evidence proves the mistake whatever the load is. A subject that
    does what no judge can read has failed (:data:`autograder.judge.verdicts.deciding.UNREADABLE`).

    Args:
        reference: The recorded behavior of the reference solution.
        seed: The seed of all random inputs.
        marks_crowded: True to return a verdict with ``crowded`` set instead of raising TooBusy, as the grader does.
        practice: The reference output with the practice drawings, if ``reference`` has a drawing of a class. A subject
            that does not pass is given a practice drawing, too, because only with these are wrong answers recorded.

    Raises:
        ExerciseFailed: The exercise's own code raised an exception.
        TooBusy: The machine was too busy to decide, or a student has waited for a long time on a busy machine.
        NotDelivered: The subject did not pass, nothing proves a mistake, and this machine may have lost messages.
    """
    began, delivered = time.monotonic(), delivers()
    # Hurry, and tell what is known so far, only if a student may be waiting, that is, in a check cell that no grader
    # runs: the code of a submission must not learn the verdict.
    waited_for = subject.in_a_notebook and not marks_crowded
    stacks: list[Part] = []
    hurry = _asking(subject, stacks) if waited_for else lambda: None
    card = GrowingCard(exercise, criterion_result, subject.tell_so_far) if waited_for else None
    look_at = partial(look, exercise, subject, seed=seed, domain_id=domain_id, hurry=hurry, card=card)
    subject.begin(domain_id)
    looks: list[Look] = []
    cut = False
    with of_exercise(exercise, reference):
        try:
            for one in _looks(exercise, reference, seed, look_at, practice, card, subject):
                looks.append(one)
                if not is_readable(one.verdict):
                    break
        except OutOfTime:
            # The machine left no time for a further look, but the last one may prove a mistake, such as a wrong name,
            # or the stacks a loop without an end.
            evidence = Evidence(stacks, reference)
            if loop := endless_loop(exercise, evidence):
                looks.append(
                    Look(Seen(evidence, doubtful=False), evidence, replace(loop, seed=seed), NO_NAMES)
                )
            elif not looks or not is_certain(exercise, looks[-1].evidence):
                raise _too_busy(looks) from None
            verdict = looks[-1].verdict
            looks.append(replace(looks[-1], verdict=replace(verdict, remarks=(*verdict.remarks, CUT))))
            cut = True
        last = looks[-1]
        decides = (
            cut or last.verdict.passed or not is_readable(last.verdict) or is_certain(exercise, last.evidence)
        )
    if not decides and not (delivered and delivers()):
        raise NotDelivered(NOT_DELIVERED)
    crowded = not decides and (last.crowded or last.seen.unmet)
    if crowded and not marks_crowded:
        raise _too_busy(looks)
    verdict = replace(last.verdict, seconds=round(time.monotonic() - began, 3))
    return replace(last, verdict=verdict, crowded=crowded)


def _asking(subject: Subject, stacks: list[Part]) -> Callable[[], None]:
    """Return a function that ends a check like :class:`Hurry`, and first adds a part with the subject's stacks."""
    hurry = Hurry(is_building=lambda: subject.is_building)

    def ask_and_end() -> None:
        try:
            hurry()
        except OutOfTime:
            # Its processor time proves nothing: the subject may wait for what the judge has not done yet.
            stacks.append(Part("cut", {}, [Event(0.0, "stack", "subject", {"text": subject.stack()})]))
            raise

    return ask_and_end


def _looks(
    exercise: Exercise,
    reference: Reference,
    seed: str,
    look_at: Callable[..., Seen],
    practice: Reference | None,
    card: GrowingCard | None,
    subject: Subject,
) -> Iterator[Look]:
    """Yield the looks that a check needs, one after the other. None may be asked for after an unreadable one."""

    def decided(seen: Seen, before: Evidence | None = None, names: Names = NO_NAMES) -> Look:
        if trouble := runner_trouble(seen.evidence.parts):
            raise JudgeFailed(f"the course could not prepare the program: {trouble}")
        evidence = replace(seen.evidence, before=before)
        return Look(seen, evidence, decide(exercise, evidence, seed), names)

    last = decided(look_at(reference, Pace.FAST))
    yield last
    # A wrong name should fail only one criterion. So the judge looks again and uses the subject's names, with which
    # it can decide the other criteria.
    looks_once = last.verdict.passed or exercise.runner or exercise.hides_causes
    if names := NO_NAMES if looks_once else misnamed(last.evidence, last.verdict):
        last = decided(look_at(reference, Pace.FAST, names=names), names=names)
        yield last
    # A look ends early if no node answers. What came until then may be right, as of a loop that ends soon.
    doubtful = last.seen.doubtful or any(part.of("unanswered") for part in last.evidence)
    again = exercise.second_look and (doubtful or not last.verdict.passed)
    if again and not _is_explained(exercise, last):
        if card is not None:
            card.words = _so_far(last)
        with Crowding() as crowding:
            seen = look_at(reference, Pace.REAL_TIME, before=last.evidence, names=last.names)
        last = last if seen.confirms else decided(seen, last.evidence, last.names)
        # No load makes so much go alike that a look confirms the first one without a doubt.
        last = replace(last, seen=seen, crowded=crowding.too_busy and (seen.doubtful or not seen.confirms))
        yield last
    tells = practice and practice.knows_wrong_answers and not last.verdict.passed
    if practice and tells and not is_certain(exercise, last.evidence):
        with contextlib.suppress(JudgeFailed):  # the verdict stands without it
            known = look_at(practice, Pace.FAST)
            earlier = last.evidence.before.parts if last.evidence.before else ()
            evidence = replace(last.evidence, before=Evidence([*known.evidence.parts, *earlier], reference))
            last = replace(last, evidence=evidence, verdict=decide(exercise, evidence, seed))
            yield last
    evidence = with_own_lines(exercise, last.evidence, last.verdict, subject.own_lines)
    if evidence is not last.evidence:
        yield replace(last, evidence=evidence, verdict=decide(exercise, evidence, seed))


def _too_busy(looks: Sequence[Look]) -> TooBusy:
    """Return the error that ends a check on a busy machine. It quotes the diagnosis so far, if there is one."""
    return TooBusy(f"{TOO_BUSY} {_so_far(looks[-1]) if looks else ''}".strip())


def _so_far(last: Look) -> str:
    """Return a sentence that quotes the diagnosis and says that it may be wrong; empty if the mistake is unknown."""
    known = last.verdict.diagnosis
    return SEEN_SO_FAR.format(known.text) if known and known.key != UNKNOWN else ""


def _is_explained(exercise: Exercise, last: Look) -> bool:
    """Return True if no second look is needed, because the evidence proves a mistake that explains all failures."""
    failed = sum(not criterion.passed for criterion in last.verdict.criteria)
    return is_certain(exercise, last.evidence) and not (last.names and failed > len(last.names))


def look(
    exercise: Exercise,
    subject: Subject,
    reference: Reference,
    pace: Pace,
    *,
    seed: str,
    domain_id: int,
    before: Evidence | None = None,
    hurry: Callable[[], None] = lambda: None,
    names: Mapping[str, Mapping[str, str]] | None = None,
    card: GrowingCard | None = None,
) -> Seen:
    """Run the scenario once and return the evidence.

    Args:
        reference: The recorded behavior of the reference solution.
        pace: The pace of this look.
        seed: The seed of all random inputs.
        before: The evidence of the first look; None if this is the first look.
        hurry: Called repeatedly while the judge waits. It may raise an exception to end the look.
        names: The wrong names that :func:`autograder.judge.verdicts.deciding.misnamed` found in an earlier look.
        card: The card of a student who waits for the check; None if no student waits.
    """

    def begin_run(ended: Sequence[Part]) -> None:
        if card is not None:
            card.begin(Evidence(ended, reference, pace is Pace.REAL_TIME, before))

    bench = TestBench(subject, domain_id, reference, pace, Random(seed), before, hurry, names)
    bench.is_waited_for, bench.begin_run = card is not None, begin_run
    confirms = False
    with contextlib.closing(bench), contextlib.suppress(Unanswered), bench.noting_what_is_unreadable():
        try:
            exercise.scenario(bench)
        except Confirmed:
            confirms = True
    # Sort the parts: a scenario may shuffle them, but the verdict's text must not depend on the order.
    places = {part.name: place for place, part in enumerate(reference.parts)}
    parts = sorted(bench.parts, key=lambda part: places.get(part.name, len(places)))
    return Seen(Evidence(parts, reference, pace is Pace.REAL_TIME), bench.doubtful, bench.unmet, confirms)
