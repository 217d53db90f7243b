"""Judges a command: ``autograder check EXERCISE -- COMMAND``."""

from __future__ import annotations

import os
import secrets
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder import exercises
from autograder.command_name import COMMAND
from autograder.dds_discovery import NoFreeDomainError
from autograder.judge import evidence_files, ros_setup
from autograder.judge.check_process import Child
from autograder.judge.machine_fitness import JudgeFailed
from autograder.kit.runners import Launches, runner_as_word
from autograder.messages.judge_messages import Report
from autograder.verdict import Verdict, not_checked
from autograder.workspaces.sources import full_disk
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.judge.one_check import Look
    from autograder.judge.subject import CommandBox
    from autograder.kit.evidence import Reference
    from autograder.kit.model import Exercise


class CommandNotFound(LookupError):
    """The command does not exist or may not be executed."""


LAUNCH_FILES = (".py", ".xml", ".yaml", ".yml")
"""File name extensions of launch files."""
FOR_BUILDS = 150.0
"""Seconds that are added to an exercise's time limit because a command may build its package first. A failed command is
judged twice. In the first part of each look, the judge waits up to twice as long as usual for the program. On an
overloaded machine, this may take three times as long (`autograder/judge/bench/subject_presence.py`).
"""
SPARE = 10.0
"""Seconds after an exercise's time limit at which its judge is assumed to have died."""


def check_and_keep(
    exercise_id: str,
    command: Sequence[str],
    *,
    seed: str | None = None,
    cwd: Path | None = None,
    box: CommandBox | None = None,
) -> tuple[Verdict, bytes]:
    """Judge a command as the subject of an exercise.

    Args:
        exercise_id: The id of the exercise, such as ``"lab_1_2.talker"``.
        command: The program and its arguments. If the exercise has inputs, they are appended as further arguments.
        seed: The seed of the random inputs; the default is a new one.
        cwd: The folder in which to run the command.
        box: The sandbox in which to run the command; None to run it with all rights of the user.

    Returns:
        The verdict, and the evidence as :mod:`autograder.judge.evidence_files` packs it. If the judge itself
        failed, the verdict's state is ``not_checked`` and the evidence is empty.

    Raises:
        UnknownExercise: No exercise has this id.
        CommandNotFound: The program does not exist.
    """
    exercise = exercises.get(exercise_id)
    # shutil.which looks up names without a slash in these folders, of which the command's working folder is one.
    folders = os.environ.get("PATH") if cwd is None else f"{os.environ.get('PATH', '')}:{cwd}"
    if not is_path(exercise, command, cwd) and shutil.which(command[0], path=folders) is None:
        raise CommandNotFound(
            f"the program {command[0]!r} does not exist here: check its spelling, and that it is executable"
        )
    if is_path(exercise, command, cwd) and (trouble := full_disk(Path(cwd or ".", command[0]))):
        return not_checked(exercise.id, exercise.title, exercise.points, trouble, key="disk_full"), b""
    chosen = seed or secrets.token_hex(8)

    def report() -> bytes:
        verdict, checked = checked_here(exercise, command, chosen, cwd, box)
        return msgspec.json.encode(
            Report(verdict, evidence=evidence_files.packed(checked) if checked else b"")
        )

    ros_setup.provide_log_folder()  # before the fork, because a child exits without removing its folders
    outcome = Child(report, exercise.limit + FOR_BUILDS + SPARE).result()
    if outcome.data is None:
        advice = f"Run `{COMMAND} doctor`."
        return not_checked(exercise.id, exercise.title, exercise.points, outcome.trouble, advice), b""
    said = msgspec.json.decode(outcome.data, type=Report)
    assert said.verdict is not None
    return said.verdict, said.evidence


def _as_run(exercise: Exercise, command: Sequence[str], cwd: Path | None) -> Sequence[str]:
    """Return the command that runs the subject.

    If ``command`` is the path of a workspace or launch file, this is ``python -m autograder.workspaces`` with the path.
    """
    wraps = exercise.wraps_commands and not is_path(exercise, command, cwd)
    if exercise.runner is None or not (wraps or is_path(exercise, command, cwd)):
        return command
    runner = python_child("-m", "autograder.workspaces", runner_as_word(exercise.runner)).command
    return [*runner, *(["--"] if wraps else []), *command]


def is_path(exercise: Exercise, command: Sequence[str], cwd: Path | None) -> bool:
    """Return True if the command is the path of a workspace or launch file and the exercise accepts one."""
    if not exercise.runner or len(command) != 1:
        return False
    path = Path(cwd or ".", command[0])
    return path.is_dir() if not isinstance(exercise.runner, Launches) else path.suffix in LAUNCH_FILES


def checked_here(
    exercise: Exercise, command: Sequence[str], seed: str, cwd: Path | None, box: CommandBox | None = None
) -> tuple[Verdict, Look | None]:
    """Judge a command in this process, which was forked for it. The evidence is None if the judge failed."""
    ros_setup.prepare_judge(boxed=box is not None)
    if box is not None:
        box.enter()
    from autograder.judge import one_check
    from autograder.judge.subject import CommandSubject

    try:
        expected = evidence_files.load_reference(exercise.id)
        with ros_setup.lease_domain() as domain_id:
            subject = CommandSubject(_as_run(exercise, command, cwd), cwd, box)
            checked = one_check.check(exercise, subject, expected, seed=seed, domain_id=domain_id)
            return checked.verdict, checked
    except (NoFreeDomainError, evidence_files.NoReference, JudgeFailed) as error:
        return not_checked(exercise.id, exercise.title, exercise.points, str(error)), None


def recorded_here(exercise: Exercise, command: Sequence[str], reference: Reference) -> Report:
    """Record what a command does in all parts of an exercise, in this process, which was forked for it."""
    ros_setup.prepare_judge()
    from autograder.judge import reference_recording
    from autograder.judge.subject import CommandSubject

    try:
        with ros_setup.lease_domain() as domain_id:
            subject = CommandSubject(_as_run(exercise, command, None))
            recorded = reference_recording.record_variant(exercise, subject, reference, domain_id=domain_id)
    except (NoFreeDomainError, JudgeFailed, reference_recording.NotRecordable) as error:
        return Report(trouble=str(error))
    return Report(reference=evidence_files.dump_reference(recorded, exercise.recorded))
