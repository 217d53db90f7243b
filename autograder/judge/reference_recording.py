"""Records a reference output: runs the reference solution through the same scenario as a student's answer.

The practice drawings of an exercise are recorded into the file of its reference output, those of a class for the class.
"""

from __future__ import annotations

import time
from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING

from autograder.judge.bench.bench import TestBench
from autograder.judge.evidence_files import as_recorded, load_reference
from autograder.judge.one_check import look
from autograder.judge.recording_differences import differences
from autograder.judge.verdicts.deciding import is_certain, judge
from autograder.kit.bench import Pace
from autograder.kit.evidence import Evidence, Reference
from autograder.kit.output.launched_processes import all_are_there, processes
from autograder.kit.output.workspace_reports import report_of
from autograder.kit.runners import RunsPrograms

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.judge.subject import Subject
    from autograder.kit.evidence import Part
    from autograder.kit.model import Exercise

TOPIC_ROLES = ("publisher", "subscription")
SEED = "reference"
"""The fixed seed of a recording, so that each recording has the same random inputs."""
LOOKS = 10
"""The maximum number of looks for a recording. On a busy machine the evidence of a look may be doubtful, so another
look is needed. With at most three looks, 1 of 36 recordings failed when eighteen ran at once on two processors.
"""
DRAWN_AGAIN = 3
"""The maximum number of times that a drawing of a class is drawn again."""
ALL_THERE = 20.0
"""Time limit in seconds of wall time for the programs of a launch to make their endpoints."""


class NotRecordable(RuntimeError):
    """A program did not show the behavior that the exercise is about, or no two records of it would be the same."""


def record(exercise: Exercise, subject: Subject, *, domain_id: int) -> Reference:
    """Record the reference solution's endpoints, then run the scenario on it.

    If the solution fails in a look, the cause may be a busy machine: a goal may have ended before it was canceled, or
    the first message may have been lost. So the scenario is run again, unless the mistake is certain or the time limit
    of a check is over.

    Returns:
        The recording of the first look in which the solution was right; if there is none, of the last look.

    Raises:
        NotRecordable: The solution had no endpoint of the exercise's roles, or every look was doubtful.
    """
    deadline = time.monotonic() + exercise.limit
    subject.begin(domain_id)
    bare = _endpoints_of_solution(exercise, subject, domain_id)
    if exercise.roles and not any(bare.interface.get(role) for role in exercise.roles):
        raise NotRecordable(f"{exercise.id}: the reference solution had no {' or '.join(exercise.roles)}")
    wrong: Reference | None = None
    for parts in _clear_looks(exercise, subject, bare, domain_id):
        recorded = replace(bare, parts=parts)
        evidence = Evidence(parts, recorded)
        if judge(exercise, evidence, SEED).passed:
            return recorded
        wrong = recorded
        # At least one look is made, however long it took to find the endpoints.
        if is_certain(exercise, evidence) or time.monotonic() > deadline:
            break
    if wrong is not None:
        return wrong
    raise NotRecordable(
        f"{exercise.id}: the reference solution did not follow the simulated clock, or canceled at a different time in "
        "each run. Wait until the machine is less busy, and record again."
    )


def record_variant(
    exercise: Exercise, subject: Subject, reference: Reference, *, domain_id: int
) -> Reference:
    """Record a wrong answer in all parts, for cards of nodes that do the same.

    Raises:
        NotRecordable: Every look was doubtful.
    """
    subject.begin(domain_id)
    bare = replace(reference, parts=(), variants=())
    for parts in _clear_looks(exercise, subject, bare, domain_id):
        return replace(bare, parts=parts)
    raise NotRecordable(
        "this wrong answer does not follow the simulated clock, so what it does differs from run to run. Take its "
        "`card` and `next_step` out of the table, or wait until the machine is less busy, and record again."
    )


def record_drawing(exercise: Exercise, subject: Subject, name: str, *, domain_id: int) -> Reference:
    """Record the reference solution in a drawing of the inputs that only one class has.

    People review the practice drawings, and the bank's answers are judged with them. A drawing of a class was never
    tried. So it is drawn again if it does not tell right answers from wrong ones, or if the solution does not do the
    same twice. If no drawing tells, the last one counts. If all practice drawings have the same answer, none can tell.

    Args:
        name: The name of the drawing, of which the exercise draws the inputs.

    Returns:
        The recording, with one part. If the drawing was drawn again, the part has a longer name.

    Raises:
        NotRecordable: The solution did the same twice in no drawing.
    """
    began, practice = time.monotonic(), load_reference(exercise.id)
    subject.begin(domain_id)
    first, *others = practice.parts
    can_tell = any(tells(exercise, replace(practice, parts=[first]), [other]) for other in others)
    for attempt in range(DRAWN_AGAIN + 1):
        bare = replace(practice, parts=(), variants=(), drawings=(f"{name}.{attempt}" if attempt else name,))
        looks = _clear_looks(exercise, subject, bare, domain_id)
        if (parts := next(looks, None)) is None:
            continue
        recorded = replace(bare, parts=parts, drawings=())
        drawn = as_recorded(recorded, exercise.recorded)
        is_last = not can_tell or attempt == DRAWN_AGAIN or time.monotonic() - began > exercise.limit / 3
        if is_last or tells(exercise, drawn, practice.parts):
            again = next(looks, None)
            if again is not None and judge(exercise, Evidence(again, drawn), SEED).passed:
                return recorded
        if is_last:
            break
    raise NotRecordable(
        f"{exercise.id}: the reference solution did not do the same twice with the same inputs. Wait until the machine "
        "is less busy, and grade again. If this stays, chance decides something that the exercise compares."
    )


def tells(exercise: Exercise, drawn: Reference, practice: Sequence[Part]) -> bool:
    """Return True if a drawing tells right answers from wrong ones: no known wrong answer passes in it.

    The known wrong answers are those that do not look at their inputs, but do what is right in a practice drawing.
    """
    (mine,) = drawn.parts
    outputs = _outputs(drawn, mine)
    return all(any(differences(_outputs(drawn, part), outputs, exercise.tolerance)) for part in practice)


def _outputs(reference: Reference, part: Part) -> Reference:
    """Return a recording that contains only the outputs of a part, without the inputs and times."""
    outputs = [replace(event, data={**event.data, "given": ""}, sim=None) for event in part.events]
    return replace(reference, parts=[replace(part, name="", events=outputs)])


def _clear_looks(
    exercise: Exercise, subject: Subject, bare: Reference, domain_id: int
) -> Iterator[Sequence[Part]]:
    """Yield the parts of each look that is not doubtful, or that agrees with an earlier one; of :data:`LOOKS` looks.

    On a busy machine, slow steps make each look doubtful. If two looks in simulated time agree, chance had no part.
    """
    doubtful: list[Reference] = []
    for _ in range(LOOKS):
        seen = look(exercise, subject, bare, Pace.FAST, seed=SEED, domain_id=domain_id)
        parts = seen.evidence.parts
        if not seen.doubtful:
            yield parts
        elif all(part.events and part.events[-1].sim is not None for part in parts):
            recorded = as_recorded(replace(bare, parts=parts), exercise.recorded)
            if any(not [*differences(earlier, recorded, exercise.tolerance)] for earlier in doubtful):
                yield parts
            doubtful.append(recorded)


def _endpoints_of_solution(exercise: Exercise, subject: Subject, domain_id: int) -> Reference:
    """Return a reference output with the solution's endpoints, and without parts."""
    bench = TestBench(subject, domain_id, Reference(exercise.id, {}), Pace.FAST, Random(SEED))
    try:
        found: dict[str, dict[str, str]] = {}
        qos: dict[str, dict[str, str]] = {role: {} for role in TOPIC_ROLES}
        for program in _programs(exercise):
            bench.part("interface")
            bench.start(*program, *exercise.sample_arguments)
            if exercise.runner:
                # The endpoints of a workspace appear only after its build, so wait until the build has ended.
                bench.wait_until(
                    lambda evidence: report_of(evidence.main) is not None or bool(processes(evidence.main)),
                    exercise.limit,
                )
            shown = bench.await_any_endpoint(exercise.roles)
            found |= {role: shown[role] for role in shown if shown[role] or role not in found}
            if bench.seen().ending is None:
                # The solution may make more endpoints after the first one, and a launch may start more programs, so
                # wait until all are there.
                bench.watch_graph(lambda evidence: all_are_there(evidence.main), ALL_THERE)
                shown = bench.await_any_endpoint(())
                found |= {role: found.get(role, {}) | shown[role] for role in shown}
            for role, named in qos.items():
                named |= bench.seen().qos(role)
        # The programs of a workspace or launch file may run one after the other. In that case only the endpoints of the
        # exercise's roles are the same in each recording, so only they are recorded.
        roles = exercise.roles if exercise.runner else tuple(found)
        asked, asked_qos = (
            {r: {n: k for n, k in of[r].items() if n not in exercise.unasked} for r in roles if r in of}
            for of in (found, qos)
        )
        return Reference(exercise.id, asked, qos=asked_qos)
    finally:
        bench.close()


def _programs(exercise: Exercise) -> list[tuple[str, ...]]:
    """Return the arguments of each of the exercise's programs; a single empty tuple if it has only one subject."""
    runner = exercise.runner
    return [(name,) for name in runner.programs] if isinstance(runner, RunsPrograms) else [()]
