"""Decides a verdict on evidence: the result of each criterion, and the diagnosis of the first known mistake in it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.judge.bench.recorder import MAX_EVENTS
from autograder.judge.bench.unreadable import FLOOD, NAME, UnreadableSubject
from autograder.judge.timeline import verdict_timeline
from autograder.judge.timeline.parting_point import claimed, own_lines_in_words, parting_point
from autograder.kit.hunts.repairs import without_causes
from autograder.kit.in_words import of_its_kind, shortened, visible
from autograder.kit.mission.track import ways
from autograder.kit.mistakes.hangs import ENDLESS_LOOP
from autograder.kit.mistakes.package_mistakes import changed_since_build
from autograder.kit.mistakes.uncalled import uncalled
from autograder.kit.model import UNKNOWN, Advice, Criterion, Exercise, Finding, Mistake
from autograder.verdict import CriterionResult, Diagnosis, State, Verdict, failed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.kit.evidence import Event, Evidence
    from autograder.messages.judge_messages import OwnLine


MAX_DETAIL = 6_000
"""The maximum length of a traceback on a card, in characters."""
UNDECIDABLE = "undecidable"
"""The key of the diagnosis of a subject that does what no judge can read."""
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


def decide(exercise: Exercise, evidence: Evidence, seed: str) -> Verdict:
    """Return the verdict that follows from evidence; a fail if the subject did what no judge can read."""
    try:
        return judge(exercise, evidence, seed)
    except UnreadableSubject as error:
        diagnosis = Diagnosis(UNDECIDABLE, *UNREADABLE[error.why])
        return replace(failed(exercise.id, exercise.title, float(exercise.points), diagnosis), seed=seed)


def is_readable(verdict: Verdict) -> bool:
    """Return False if the subject did what no judge can read."""
    return verdict.diagnosis is None or verdict.diagnosis.key != UNDECIDABLE


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
    criteria = tuple(
        criterion_result(exercise, one, evidence, lost.get(one.name)) for one in exercise.criteria
    )
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
        # If the exercise hides its causes, this sentence would tell one.
        ways=tuple(replace(one, supposed=bool(lost) and shown is evidence) for one in ways(shown)),
        seed=seed,
        # The last lines of a traceback name the error and the student's line.
        detail=traceback[-MAX_DETAIL:],
        counts=exercise.counts_as_a_whole,
        nothing_seen=not any(one.passed for one in criteria) and verdict_timeline.shows_nothing(evidence),
    )


def criterion_result(
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
    if found := _recognized(exercise.mistakes, evidence):
        return _of_known(exercise, evidence, *found), found[1].traceback
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


def _of_known(exercise: Exercise, evidence: Evidence, mistake: Mistake, advice: Advice) -> Diagnosis:
    """Return the diagnosis of a known mistake."""
    text, next_step = (
        _cut(of_its_kind(shortened(visible(words)), evidence.in_a_notebook), 2 * MAX_WORDS)
        for words in (f"{advice.text} {own_lines_in_words(evidence)}".rstrip(), advice.next_step)
    )
    # One entry of a ladder may recognize several variants of a mistake; then its advice names the key.
    return Diagnosis(advice.key or mistake.key, text, next_step, hidden=exercise.hides_causes)


def _recognized(mistakes: Iterable[Mistake], evidence: Evidence) -> tuple[Mistake, Advice] | None:
    for mistake in mistakes:
        if (advice := mistake.recognize(evidence)) is not None:
            return mistake, advice
    return None


def is_certain(exercise: Exercise, evidence: Evidence) -> bool:
    """Return True if the evidence proves a mistake, no matter how busy the machine was."""
    found = _recognized(exercise.mistakes, evidence)
    return found is not None and found[0].certain


def endless_loop(exercise: Exercise, stacks: Evidence) -> Verdict | None:
    """Return a fail if the stacks of a subject prove a loop without an end, whatever else it did; else None."""
    loops = (one for one in exercise.mistakes if one.key == ENDLESS_LOOP.key and one.certain)
    if not (found := _recognized(loops, stacks)):
        return None
    return failed(exercise.id, exercise.title, float(exercise.points), _of_known(exercise, stacks, *found))


def _cut(text: str, limit: int = MAX_WORDS) -> str:
    """Return a sentence, cut to the length that fits on a card."""
    return text if len(text) <= limit else f"{text[: limit - 1]}…"


def _causes(exercise: Exercise, evidence: Evidence, verdict: Verdict) -> Sequence[Sequence[str]]:
    """Return the methods and classes whose lines the card quotes, each after others that do the same."""
    if known := _recognized(exercise.mistakes, evidence):
        return [[name] for name in known[1].uses]
    if point := parting_point(evidence):
        return point.causes
    lost = (one for one, result in zip(exercise.criteria, verdict.criteria, strict=True) if not result.passed)
    return [[name] for name in next(lost).uses]


def with_own_lines(
    exercise: Exercise, evidence: Evidence, verdict: Verdict, own_lines: Callable[[], Sequence[OwnLine]]
) -> Evidence:
    """Return the evidence with those lines of the student's code that the card quotes. They decide no point.

    Args:
        own_lines: Reads the lines. That takes a process, so it is called only if the card may quote a line.
    """
    mutants = evidence.reference.mutants
    reads = not verdict.passed and (mutants or _causes(exercise, evidence, verdict))
    lines = own_lines() if reads and is_readable(verdict) else ()
    if not lines or not evidence.parts:
        return evidence
    if events := uncalled(lines, mutants.methods if mutants else ()):
        evidence = _with_events(evidence, events)
        verdict = decide(exercise, evidence, verdict.seed)
    raising = [line for line in lines if f'/{line.place}"' in verdict.detail]
    causes = _causes(exercise, evidence, verdict) if is_readable(verdict) else ()
    return _with_events(evidence, claimed(causes, raising or lines))


def _with_events(evidence: Evidence, events: Sequence[Event]) -> Evidence:
    first, *others = evidence.parts
    return replace(evidence, parts=[replace(first, events=[*first.events, *events]), *others])


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
