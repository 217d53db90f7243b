"""Handle one check for a notebook in a forked child of the judge, from the first message to the verdict."""

from __future__ import annotations

import contextlib
import hashlib
import secrets
from typing import TYPE_CHECKING

from msgspec.structs import replace

from autograder import exercises
from autograder.judge.bench.wire import JudgeFailed
from autograder.judge.serving import domain
from autograder.judge.subjects.path_subject import PathSubject
from autograder.judge.subjects.remote_subject import RemotePath, RemoteSubject
from autograder.judge.verdicts import keeping, record, reference, trial
from autograder.judge.verdicts.exercise_code import WHAT_TO_DO, of_exercise
from autograder.messages.checks import Check, Judged, Refused
from autograder.messages.lines import Hangup, Lines, NotUnderstood
from autograder.messages.orders import Open, Report
from autograder.verdict import Verdict, not_checked

if TYPE_CHECKING:
    import socket

    from autograder.judge.verdicts.trial import Checked
    from autograder.kit.model import Exercise
    from autograder.messages.lines import Message

FIRST_WORD = 5.0
"""Time limit in seconds for a notebook's first message, which requests a check."""
MAX_NAME = 100
"""The maximum number of characters of an exercise's name; the rest is ignored."""


def converse(connection: socket.socket, order: Open | None) -> Report:
    """Read which exercise the notebook asks for, judge it, and send the notebook the verdict.

    Args:
        connection: The socket to the notebook.
        order: The grader's order for the only allowed check; None if the notebook may request any check.

    Returns:
        The report with the verdict; an empty report if no allowed check was requested.
    """
    wanted = order or Open("", secrets.token_hex(8))
    lines = Lines(connection)
    connection.settimeout(FIRST_WORD)
    try:
        first = lines.hear(Check)
    except Hangup:
        return Report()  # the notebook connected and sent nothing
    except NotUnderstood:
        _tell(lines, Refused("the first message must request a check"))
        return Report()
    connection.settimeout(None)
    asked = first.exercise[:MAX_NAME].encode("utf-8", "replace").decode()
    try:
        exercise = exercises.get(asked)
    except exercises.UnknownExercise as error:
        _tell(lines, Refused(str(error)))
        return Report()
    except exercises.BrokenExercise as error:
        _tell(lines, Refused(f"{' '.join(str(error).split())}\n{WHAT_TO_DO}"))
        return Report()
    if wanted.exercise and asked != wanted.exercise:
        _tell(lines, Refused(f"the check cell of {wanted.exercise} asked for {asked}"))
        return Report()
    subject: RemoteSubject | PathSubject
    if wanted.workspaces and exercise.runner:
        # Ignore how the notebook describes its subject, because the grader builds and runs the sources.
        subject = PathSubject(lines, exercise.id, wanted.workspaces)
    elif exercise.runner and first.kind == "path":
        subject = RemotePath(lines)
    else:
        subject = RemoteSubject(lines, is_class=first.kind == "class")
    # If the load of the machine may have spoiled the check, a student gets no verdict. A grader, however, gets a
    # verdict that is marked as crowded, and repeats the check while nothing else runs.
    seed = own_seed(wanted.seed, exercise.id)
    report, checked = _report(exercise, subject, seed, wanted, marks_crowded=order is not None)
    _tell(lines, Judged(None if wanted.boxed else _shown(exercise, report)))
    # The notebook has its verdict and continues while the evidence is packed here.
    return replace(report, evidence=keeping.packed(checked)) if wanted.evidence and checked else report


def own_seed(seed: str, exercise_id: str) -> str:
    """Derive the seed of one check. A student sees this seed on the card, but cannot compute other seeds from it."""
    return hashlib.sha256(f"{len(seed)}:{seed}{exercise_id}".encode()).hexdigest()[:16]


def _tell(lines: Lines, message: Message) -> None:
    # If the notebook has disconnected, the verdict is valid nevertheless.
    with contextlib.suppress(Hangup):
        lines.say(message)


def _report(
    exercise: Exercise,
    subject: RemoteSubject | PathSubject,
    seed: str,
    wanted: Open,
    *,
    marks_crowded: bool,
) -> tuple[Report, Checked | None]:
    try:
        with domain.lease(alone=wanted.boxed) as domain_id:
            if not wanted.record:
                stored = reference.load(exercise.id)
                checked = trial.check(
                    exercise, subject, stored, seed=seed, domain_id=domain_id, marks_crowded=marks_crowded
                )
                return Report(checked.verdict, crowded=checked.crowded), checked
            with of_exercise(exercise):
                recorded = record.record(exercise, subject, domain_id=domain_id)
                verdict = trial.judge(exercise, record.as_evidence(recorded), seed)
            return Report(verdict, reference.dump(recorded, exercise.recorded)), None
    except (domain.NoFreeDomainError, reference.NoReference, record.NotRecordable, JudgeFailed) as error:
        return Report(trouble=str(error)), None
    except Hangup:
        return Report(), None  # the notebook disconnected before it had sent its sources


def _shown(exercise: Exercise, report: Report) -> Verdict:
    return report.verdict or not_checked(exercise.id, exercise.title, exercise.points, report.trouble)
