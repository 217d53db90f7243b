"""Record a reference output: look at the reference solution with the same eyes as at anybody's."""

from __future__ import annotations

import time
from random import Random
from typing import TYPE_CHECKING

from autograder.judge.bench.bench import TestBench
from autograder.judge.verdicts.trial import is_certain, judge, look
from autograder.kit.evidence import Evidence, Reference
from autograder.kit.launch_report import processes
from autograder.kit.model import Exercise, Pace
from autograder.kit.runners import RunsPrograms
from autograder.kit.workspace_report import report_of

if TYPE_CHECKING:
    from autograder.judge.subjects.subject import Subject

SEED = "reference"
"""Recording draws the same inputs each time."""
LOOKS = 10
"""The number of looks at a subject whose evidence a busy machine has blurred. With three looks, 1 recording of 36 was
given up where eighteen were made at once on two processors."""


class NotRecordable(RuntimeError):
    """The reference solution did not show what the exercise is about."""


def record(exercise: Exercise, subject: Subject, *, domain_id: int) -> Reference:
    """Look at the reference solution's interface, then run the scenario on it.

    As with any subject, a fast look that fails proves nothing unless the mistake is certain: on a busy machine a goal
    may be over before it is canceled, or the first message lost before the judge could hear it. So it is looked at
    again, but not once the recording has taken as long as a check may.

    Returns:
        The recording. Where the solution was right in none of the looks, it is the last one, by which it is not.

    Raises:
        NotRecordable: It never had an endpoint of the exercise's roles, or each look was doubtful.
    """
    deadline = time.monotonic() + exercise.limit
    subject.begin(domain_id)
    interface = _interface(exercise, subject, domain_id)
    if exercise.roles and not any(interface.get(role) for role in exercise.roles):
        raise NotRecordable(f"{exercise.id}: the reference solution showed no {' or '.join(exercise.roles)}")
    bare = Reference(exercise.id, interface)
    wrong: Reference | None = None
    for number in range(LOOKS):
        if number and time.monotonic() > deadline:
            break
        seen = look(exercise, subject, bare, Pace.FAST, seed=SEED, domain_id=domain_id)
        if seen.doubtful:
            continue
        recorded = Reference(exercise.id, interface, seen.evidence.parts)
        evidence = as_evidence(recorded)
        if judge(exercise, evidence, SEED).passed:
            return recorded
        wrong = recorded
        if is_certain(exercise, evidence):
            break
    if wrong is not None:
        return wrong
    raise NotRecordable(
        f"{exercise.id}: the reference solution did not follow the clock, or asked to cancel at another moment in "
        "each run; is the machine busy?"
    )


def as_evidence(recorded: Reference) -> Evidence:
    """The recording, as the evidence of a subject that is its own reference."""
    return Evidence(recorded.parts, recorded)


def _interface(exercise: Exercise, subject: Subject, domain_id: int) -> dict[str, dict[str, str]]:
    bench = TestBench(subject, domain_id, Reference(exercise.id, {}), Pace.FAST, Random(SEED))
    try:
        found: dict[str, dict[str, str]] = {}
        for program in _programs(exercise):
            bench.part("interface")
            bench.start(*program, *exercise.sample_arguments)
            if exercise.runner:
                # A workspace is built first, and shows its face only then.
                bench.wait_until(_is_at_work, exercise.limit)
            shown = bench.await_any_endpoint(exercise.roles)
            found |= {role: shown[role] for role in shown if shown[role] or role not in found}
            if not exercise.runner and bench.seen().ending is None:
                # It may make more than the first that was seen, and no more is waited for than until all is made.
                shown = bench.await_any_endpoint(())
                found |= {role: found.get(role, {}) | shown[role] for role in shown}
        # Several programs are not all there at once: only what was waited for is sure to be the same each time.
        return {role: found[role] for role in exercise.roles} if exercise.runner else found
    finally:
        bench.close()


def _programs(exercise: Exercise) -> list[tuple[str, ...]]:
    """The arguments that choose each program of the exercise; one empty tuple where there is only one subject."""
    runner = exercise.runner
    return [(name,) for name in runner.programs] if isinstance(runner, RunsPrograms) else [()]


def _is_at_work(evidence: Evidence) -> bool:
    return report_of(evidence.main) is not None or bool(processes(evidence.main))
