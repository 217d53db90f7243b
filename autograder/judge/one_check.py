"""Runs one check: one or two looks, the verdict on their evidence, and the diagnosis of a known mistake."""

from __future__ import annotations

import contextlib
import time
import traceback
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

from autograder import exercises, kit
from autograder.judge.bench.bench import Confirmed, TestBench
from autograder.judge.bench.recorder import MAX_EVENTS
from autograder.judge.bench.subject_time import Unanswered
from autograder.judge.bench.unreadable import FLOOD, NAME, UnreadableSubject
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
from autograder.judge.timeline import verdict_timeline
from autograder.judge.timeline.growing_card import GrowingCard
from autograder.judge.timeline.parting_point import claimed, own_lines_in_words, parting_point
from autograder.kit.bench import Pace
from autograder.kit.evidence import Evidence, Reference
from autograder.kit.hunts.repairs import without_causes
from autograder.kit.in_words import of_its_kind, shortened, visible
from autograder.kit.mission.track import ways
from autograder.kit.mistakes.package_mistakes import changed_since_build
from autograder.kit.mistakes.uncalled import uncalled
from autograder.kit.model import UNKNOWN, Advice, Criterion, Exercise, Finding, Mistake
from autograder.kit.runners import runner_trouble
from autograder.verdict import CriterionResult, Diagnosis, State, Verdict, failed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from autograder.judge.subject import Subject
    from autograder.kit.evidence import Event, Part
    from autograder.messages.judge_messages import OwnLine


MAX_DETAIL = 6_000
"""The maximum length of a traceback on a card, in characters."""
UNREADABLE = {
    FLOOD: (
        f"Your program said and sent far too much: the judge reads at most {MAX_EVENTS:,} lines, messages and calls.",
        "Log what the task asks for, one short line for each thing that happens, and nothing else.",
    ),
    NAME: (
        "A node, topic, service or action of your program has a name that ROS does not allow, so the judge cannot read "
        "what is on the ROS graph.",
        "Give each of them a name of letters, digits and underscores, as the task does.",
    ),
}
"""What a subject did that no judge can read, and what the student should do now."""
MAX_WORDS = 500
"""The maximum length of one sentence of a verdict, in characters; it may quote the subject's output."""


CUT = (
    "The machine is busy, so the judge did not look again. After you have corrected what the card names, more criteria "
    "may be met than it seems now."
)
"""A remark on a check that a busy machine has cut after a look that proves a mistake."""


@dataclass(frozen=True)
class Seen:
    """The result of one look.

    Attributes:
        evidence: The recorded events.
        doubtful: True if even a pass must be confirmed in real time.
        unmet: True if a run began before the subject's participant had discovered the judge's endpoints.
        confirms: True if this look in real time went as the first one, whose evidence decides.
    """

    evidence: Evidence
    doubtful: bool
    unmet: bool = False
    confirms: bool = False


@dataclass(frozen=True)
class Checked:
    """The result of a check.

    Attributes:
        verdict: The verdict.
        evidence: The evidence from which the verdict was derived.
        crowded: True if the verdict is not a pass and may be unfair: nothing proves a mistake, and either the machine
            was too busy in the look in real time, or the subject had not discovered the judge's endpoints.
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
    practice: Reference | None = None,
) -> Checked:
    """Judge a subject in one look, or in two looks if the first does not decide.

    A subject that passes the first look, in simulated time, has passed. If it fails, a second look in real time
    decides, unless the evidence proves the mistake whatever the load is. A subject that
    does what no judge can read has failed (:data:`UNREADABLE`).

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
    with of_exercise(exercise, reference):
        return _check(exercise, subject, reference, seed, domain_id, marks_crowded, practice)


def _check(
    exercise: Exercise,
    subject: Subject,
    reference: Reference,
    seed: str,
    domain_id: int,
    marks_crowded: bool,
    practice: Reference | None,
) -> Checked:
    began = time.monotonic()
    crowded, delivered = False, delivers()
    # Hurry, and tell what is known so far, only if a student may be waiting, that is, in a check cell that no grader
    # runs: the code of a submission must not learn the verdict.
    waited_for = subject.in_a_notebook and not marks_crowded
    hurry = Hurry(is_building=lambda: subject.is_building) if waited_for else lambda: None
    card = GrowingCard(exercise, _result, subject.tell_so_far) if waited_for else None
    names: Mapping[str, Mapping[str, str]] = {}
    verdict: Verdict | None = None
    looks = partial(
        look, exercise, subject, reference, seed=seed, domain_id=domain_id, hurry=hurry, card=card
    )

    def next_look(pace: Pace, before: Evidence | None = None) -> Seen:
        try:
            seen = looks(pace, before=before, names=names)
        except OutOfTime:
            raise _too_busy(verdict) from None
        if trouble := runner_trouble(seen.evidence.parts):
            raise JudgeFailed(f"the course could not prepare the program: {trouble}")
        return seen

    subject.begin(domain_id)
    seen = next_look(Pace.FAST)
    evidence = seen.evidence
    try:
        verdict = judge(exercise, evidence, seed)
        # A wrong name should fail only one criterion. So the judge looks again and uses the subject's names, with which
        # it can decide the other criteria.
        looks_once = verdict.passed or exercise.runner or exercise.hides_causes
        names = {} if looks_once else misnamed(evidence, verdict)
        if names:
            seen = next_look(Pace.FAST)
            evidence = seen.evidence
            verdict = judge(exercise, evidence, seed)
        # A look ends early if no node answers. What came until then may be right, as of a loop that ends soon.
        doubtful = seen.doubtful or any(part.of("unanswered") for part in evidence)
        again = exercise.second_look and (doubtful or not verdict.passed)
        again = again and not _is_explained(exercise, evidence, verdict, names)
        if again:
            if card is not None:
                card.words = _so_far(verdict)
            with Crowding() as crowding:
                seen = next_look(Pace.REAL_TIME, evidence)
            if not seen.confirms:
                evidence = replace(seen.evidence, before=evidence)
                verdict = judge(exercise, evidence, seed)
        if (
            practice
            and practice.knows_wrong_answers
            and not (verdict.passed or is_certain(exercise, evidence))
        ):
            with contextlib.suppress(JudgeFailed):  # the verdict stands without it
                known = look(exercise, subject, practice, Pace.FAST, seed=seed, domain_id=domain_id)
                earlier = evidence.before.parts if evidence.before else ()
                before = Evidence([*known.evidence.parts, *earlier], reference)
                evidence = replace(evidence, before=before)
                verdict = judge(exercise, evidence, seed)
        # To read the lines of a program takes a process.
        reads = not verdict.passed and (evidence.reference.mutants or _causes(exercise, evidence, verdict))
        if reads and (lines := subject.own_lines()):
            evidence = _with_own_lines(exercise, evidence, verdict, lines)
            verdict = judge(exercise, evidence, seed)
        if not verdict.passed:
            certain = is_certain(exercise, evidence)
            crowded = not certain and (seen.unmet or (again and crowding.too_busy and not seen.confirms))
            if not certain and not (delivered and delivers()):
                raise NotDelivered(NOT_DELIVERED)
    except UnreadableSubject as error:
        verdict = _undecidable(exercise, seed, error.why)
    except TooBusy:
        # The machine left no time for a further look, but the last whole one may prove a mistake, such as a wrong name.
        if verdict is None or not is_certain(exercise, evidence):
            raise
        verdict = replace(verdict, remarks=(*verdict.remarks, CUT))
    if crowded and not marks_crowded:
        raise _too_busy(verdict)
    return Checked(replace(verdict, seconds=round(time.monotonic() - began, 3)), evidence, crowded)


def _causes(exercise: Exercise, evidence: Evidence, verdict: Verdict) -> Sequence[Sequence[str]]:
    """Return the methods and classes whose lines the card quotes, each after others that do the same."""
    if known := _recognized(exercise, evidence):
        return [[name] for name in known[1].uses]
    if point := parting_point(evidence):
        return point.causes
    lost = (one for one, result in zip(exercise.criteria, verdict.criteria, strict=True) if not result.passed)
    return [[name] for name in next(lost).uses]


def _with_own_lines(
    exercise: Exercise, evidence: Evidence, verdict: Verdict, lines: Sequence[OwnLine]
) -> Evidence:
    """Return the evidence with those lines of the student's code that the card quotes. They decide no point."""
    if not evidence.parts:
        return evidence
    mutants = evidence.reference.mutants
    if events := uncalled(lines, mutants.methods if mutants else ()):
        evidence = _with_events(evidence, events)
        verdict = judge(exercise, evidence, verdict.seed)
    raising = [line for line in lines if f'/{line.place}"' in verdict.detail]
    return _with_events(evidence, claimed(_causes(exercise, evidence, verdict), raising or lines))


def _with_events(evidence: Evidence, events: Sequence[Event]) -> Evidence:
    first, *others = evidence.parts
    return replace(evidence, parts=[replace(first, events=[*first.events, *events]), *others])


def _too_busy(verdict: Verdict | None) -> TooBusy:
    """Return the error that ends a check on a busy machine. It quotes the diagnosis so far, if there is one."""
    return TooBusy(f"{TOO_BUSY} {_so_far(verdict) if verdict else ''}".strip())


def _is_explained(
    exercise: Exercise, evidence: Evidence, verdict: Verdict, names: Mapping[str, object]
) -> bool:
    """Return True if no second look is needed, because the evidence proves a mistake that explains all failures."""
    failed = sum(not criterion.passed for criterion in verdict.criteria)
    return is_certain(exercise, evidence) and not (names and failed > len(names))


def _so_far(verdict: Verdict) -> str:
    """Return a sentence that quotes the diagnosis and says that it may be wrong; empty if the mistake is unknown."""
    known = verdict.diagnosis
    return SEEN_SO_FAR.format(known.text) if known and known.key != UNKNOWN else ""


def decide(exercise: Exercise, evidence: Evidence, seed: str) -> Verdict:
    """Return the verdict that follows from evidence; a fail if the subject did what no judge can read."""
    try:
        return judge(exercise, evidence, seed)
    except UnreadableSubject as error:
        return _undecidable(exercise, seed, error.why)


def _undecidable(exercise: Exercise, seed: str, why: str) -> Verdict:
    diagnosis = Diagnosis("undecidable", *UNREADABLE[why])
    return replace(failed(exercise.id, exercise.title, float(exercise.points), diagnosis), seed=seed)


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
        names: The wrong names that :func:`autograder.judge.one_check.misnamed` found in an earlier look.
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


def judge(exercise: Exercise, evidence: Evidence, seed: str) -> Verdict:
    """Return the verdict that follows from the evidence.

    Raises:
        UnreadableSubject: The subject did what no judge can read.
    """
    # The decision on more events would take minutes. The bank's answers have at most about a thousand in a part.
    if sum(len(part.events) for part in evidence) > MAX_EVENTS:
        raise UnreadableSubject(FLOOD)
    if unreadable := [event for part in evidence for event in part.of("unreadable")]:
        raise UnreadableSubject(unreadable[0].name)
    lost = {event.data["costs"]: event for part in evidence for event in part.of("misnamed")}
    criteria = tuple(_result(exercise, one, evidence, lost.get(one.name)) for one in exercise.criteria)
    passed = all(criterion.passed for criterion in criteria)
    diagnosis, traceback = (None, "") if passed else diagnose(exercise, evidence, criteria)
    told = (diagnosis.text if diagnosis else "", *(one.seen for one in criteria if not one.passed))
    remarks = (*exercise.remarks, *([changed_since_build] if exercise.runner else []))
    shown = without_causes(evidence) if exercise.hides_causes and not passed else evidence
    return Verdict(
        exercise=exercise.id,
        title=exercise.title,
        state=State.PASSED if passed else State.FAILED,
        score=float(sum(c.points for c in criteria if c.passed)),
        max_score=float(exercise.points),
        criteria=criteria,
        diagnosis=diagnosis,
        remarks=tuple(_cut(text) for remark in remarks if (text := remark(evidence))),
        timeline=verdict_timeline.moments(shown, " ".join(told), missed=not passed),
        ways=ways(shown),
        seed=seed,
        # The last lines of a traceback name the error and the student's line.
        detail=traceback[-MAX_DETAIL:],
        counts=exercise.counts_as_a_whole,
        nothing_seen=not any(one.passed for one in criteria) and verdict_timeline.shows_nothing(evidence),
    )


def _result(
    exercise: Exercise, criterion: Criterion, evidence: Evidence, wrong: Event | None = None
) -> CriterionResult:
    """Return the result of a criterion; not met if it is the one that a wrong name should fail."""
    finding = criterion.judge(evidence)
    if wrong is not None and finding.passed:
        finding = Finding(False, f"the name {wrong.name}", f"the name {wrong.data['real']}")
    expected, seen = _cut(finding.expected), _cut(finding.seen)
    counts = exercise.counts.get(criterion.name, "")
    return CriterionResult(
        criterion.name, criterion.title, criterion.points, finding.passed, expected, seen, counts
    )


def diagnose(
    exercise: Exercise, evidence: Evidence, criteria: Sequence[CriterionResult] = ()
) -> tuple[Diagnosis, str]:
    """Return the diagnosis of the first known mistake in the evidence, and the traceback that shows it, if any.

    If no mistake is known, the diagnosis quotes the event at which the run leaves the reference solution's. If that is
    not clear either, it quotes the first criterion that is not met.

    Another traceback is not returned. It may come from another run and from a correct line, but a student would take it
    for the mistake.
    """
    found = _recognized(exercise, evidence)
    if found is not None:
        mistake, advice = found
        in_a_notebook = evidence.in_a_notebook
        text, next_step = (
            _cut(of_its_kind(shortened(visible(words)), in_a_notebook), 2 * MAX_WORDS)
            for words in (f"{advice.text} {own_lines_in_words(evidence)}".rstrip(), advice.next_step)
        )
        # One entry of a ladder may recognize several variants of a mistake; then its advice names the key.
        key = advice.key or mistake.key
        return Diagnosis(key, text, next_step, hidden=exercise.hides_causes), advice.traceback
    failed = next((one for one in criteria if not one.passed), None)
    seen = f"“{failed.title}” is not met: {failed.seen}. Asked: {failed.expected}." if failed else ""
    point = parting_point(evidence)
    lines = own_lines_in_words(evidence)
    law = [words for words, names in exercise.text.items() if failed and failed.name in names.split()]
    says = f"The task says: “{law[0].rstrip('.')}”." if len(law) == 1 else ""
    words = " ".join(filter(None, (point.text if point else seen, says, lines)))
    next_step = "Compare this moment of the run with the task, and go through your code up to there."
    if lines.startswith("No line"):
        next_step = "Write the line that is missing, as the task asks for it."
    text = of_its_kind(shortened(visible(words)), evidence.in_a_notebook)
    return Diagnosis(UNKNOWN, _cut(text, 2 * MAX_WORDS), next_step), ""


def _recognized(exercise: Exercise, evidence: Evidence) -> tuple[Mistake, Advice] | None:
    for mistake in exercise.mistakes:
        advice = mistake.recognize(evidence)
        if advice is not None:
            return mistake, advice
    return None


def is_certain(exercise: Exercise, evidence: Evidence) -> bool:
    """Return True if the evidence proves a mistake, no matter how busy the machine was."""
    found = _recognized(exercise, evidence)
    return found is not None and found[0].certain


def _cut(text: str, limit: int = MAX_WORDS) -> str:
    """Return a sentence, cut to the length that fits on a card."""
    return text if len(text) <= limit else f"{text[: limit - 1]}…"


WHAT_TO_DO = "Show this card to your instructor: the exercise has to be corrected first."
NOT_THE_EXERCISE = "Show this card to your instructor: the judge has to learn to read what your program does."
_KIT = Path(kit.__file__).parent
MAX_QUOTED_ERROR = 300
"""The maximum length of the quoted error, in characters. It is limited because the error may contain output of the
subject.
"""


class ExerciseFailed(JudgeFailed):
    """The code of an exercise or of the kit raised an exception."""


@contextlib.contextmanager
def of_exercise(exercise: Exercise, reference: Reference | None = None) -> Iterator[None]:
    """Turn an exception in an exercise's own code into an :class:`ExerciseFailed`, which says what to do about it.

    Args:
        reference: The recording of the reference solution; None if the solution is the subject.

    Raises:
        ExerciseFailed: The code in the block raised an exception, and code of the exercise or of the kit called it.
    """
    try:
        yield
    except (JudgeFailed, OSError):
        raise
    except Exception as error:
        where = _line_of_exercise(error, exercise)
        if not where:
            raise
        words = " ".join(f"{type(error).__name__}: {error}".split())[:MAX_QUOTED_ERROR]
        whose, what_to_do = "The exercise has a fault", WHAT_TO_DO
        if reference is not None and not _fails_on_solution(exercise, reference):
            whose, what_to_do = "The judge cannot read what your program did", NOT_THE_EXERCISE
        raise ExerciseFailed(f"{whose}: {words} ({where}).\n{what_to_do}") from error


def _fails_on_solution(exercise: Exercise, reference: Reference) -> bool:
    """Return True if the exercise's criteria or mistakes raise an exception about the reference solution, too.

    This decides no point: it tells whether the exercise is to blame for a check without a verdict.
    """
    solution = Evidence(reference.parts, reference)
    try:
        for criterion in exercise.criteria:
            criterion.judge(solution)
        _recognized(exercise, solution)
    except Exception:
        return True
    return False


def _line_of_exercise(error: Exception, exercise: Exercise) -> str:
    """Return the file and line of the exercise's code, or else of the kit's, that raised the error; empty if none."""
    frames = traceback.extract_tb(error.__traceback__)
    for folder in (exercises.path(exercise.id).parent, _KIT):
        for frame in reversed(frames):
            if folder in Path(frame.filename).parents:
                return f"{Path(frame.filename).name}, line {frame.lineno}"
    return ""


def misnamed(evidence: Evidence, verdict: Verdict) -> dict[str, dict[str, str]]:
    """Return the endpoints to which the subject gives a wrong name; the keys are the right names, as in the task.

    An endpoint counts as misnamed if, in all parts, the subject has no endpoint with the right name, role and type, but
    exactly one other endpoint with this role and type. If there are two others, neither is returned, because it is
    unclear which one was meant.

    Args:
        evidence: The evidence of a look in which the judge used the names in the task.
        verdict: The verdict on this evidence, which is not a pass.

    Returns:
        For each name: ``real``, the name that the subject uses, and ``costs``, the name of the first criterion that
        fails because of the wrong name.
    """
    costs = next(criterion.name for criterion in verdict.criteria if not criterion.passed)
    found: dict[str, dict[str, str]] = {}
    for role, asked in evidence.reference.interface.items():
        made = {name: kind for part in evidence for name, kind in part.endpoints(role).items()}
        for kind in set(asked.values()):
            missing = [name for name, type_name in asked.items() if type_name == kind and name not in made]
            others = [name for name, type_name in made.items() if type_name == kind and name not in asked]
            if len(missing) == len(others) == 1:
                found[missing[0]] = {"real": others[0], "costs": costs}
    return found
