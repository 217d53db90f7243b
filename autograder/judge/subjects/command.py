"""Judge a command: ``autograder check EXERCISE -- COMMAND``."""

from __future__ import annotations

import os
import secrets
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder import exercises
from autograder.judge import settings
from autograder.judge.serving.fork import Child
from autograder.kit.runners import Launches
from autograder.messages.orders import Report
from autograder.verdict import Verdict, not_checked
from environment.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.judge.subjects.command_subject import Box
    from autograder.judge.verdicts.trial import Checked
    from autograder.kit.model import Exercise


class CommandNotFound(LookupError):
    """The command does not exist or may not be executed."""


LAUNCH_FILES = (".py", ".xml", ".yaml", ".yml")
"""The endings of a launch file's name."""
FOR_BUILDS = 150.0
"""Seconds that a check of a command may take longer than its exercise says, because the command builds its package
first: in the first part of each of two looks it is waited for twice as long again, and up to three times as long on a
crowded machine (`autograder/judge/bench/presence.py`)."""
SPARE = 10.0
"""Seconds beyond an exercise's own limit before its judge is taken to have died."""


def check_and_keep(
    exercise_id: str,
    command: Sequence[str],
    *,
    seed: str | None = None,
    cwd: Path | None = None,
    box: Box | None = None,
) -> tuple[Verdict, bytes]:
    """Run a command as the subject of an exercise.

    Args:
        exercise_id: Such as ``"lab_1_2.talker"``.
        command: The program and its arguments; an exercise with inputs appends them.
        seed: What random inputs are drawn from; a new one where none is given.
        cwd: The folder to run it in.
        box: Where to run it, shut off from the user's files and network; with all rights of the user where None.

    Returns:
        The verdict, and the evidence as :mod:`autograder.judge.verdicts.keeping` packs it. Where the judge itself had
        trouble, the verdict's state is ``not_checked`` and the evidence is empty.

    Raises:
        UnknownExercise: No exercise has this id.
        CommandNotFound: There is no such program.
    """
    exercise = exercises.get(exercise_id)
    if not is_path(exercise, command, cwd) and shutil.which(command[0], path=_search_path(cwd)) is None:
        raise CommandNotFound(
            f"there is no program {command[0]!r} to run here; is it spelt right, and executable?"
        )
    chosen = seed or secrets.token_hex(8)

    def report() -> bytes:
        verdict, checked = checked_here(exercise, command, chosen, cwd, box)
        return msgspec.json.encode(Report(verdict, evidence=_packed(checked)))

    settings.provide_log_folder()  # here, because the child ends without tidying up
    outcome = Child(report, exercise.limit + FOR_BUILDS + SPARE).result()
    if outcome.data is None:
        advice = "Run `autograder doctor`."
        return not_checked(exercise.id, exercise.title, exercise.points, outcome.trouble, advice), b""
    said = msgspec.json.decode(outcome.data, type=Report)
    assert said.verdict is not None
    return said.verdict, said.evidence


def as_run(exercise: Exercise, command: Sequence[str], cwd: Path | None) -> Sequence[str]:
    """The command that is really run: a path in place of a command is built, run or launched by a runner."""
    runner = python_child("-m", "autograder.workspaces", exercise.id).command
    if is_path(exercise, command, cwd):
        return [*runner, command[0]]
    return [*runner, "--", *command] if exercise.wraps_commands else command


def is_path(exercise: Exercise, command: Sequence[str], cwd: Path | None) -> bool:
    """True if a command is the path of a workspace or a launch file, for an exercise that takes one."""
    if not exercise.runner or len(command) != 1:
        return False
    path = Path(cwd or ".", command[0])
    return path.is_dir() if not isinstance(exercise.runner, Launches) else path.suffix in LAUNCH_FILES


def _search_path(cwd: Path | None) -> str | None:
    # A name with a slash is looked up from the folder that the command will run in.
    return os.environ.get("PATH") if cwd is None else f"{os.environ.get('PATH', '')}:{cwd}"


def _packed(checked: Checked | None) -> bytes:
    from autograder.judge.verdicts import keeping

    return keeping.packed(checked) if checked else b""


def checked_here(
    exercise: Exercise, command: Sequence[str], seed: str, cwd: Path | None, box: Box | None = None
) -> tuple[Verdict, Checked | None]:
    """Judge a command in this very process, a fork made for it; no evidence where the judge itself had trouble."""
    settings.prepare_judge(boxed=box is not None)
    if box is not None:
        box.enter()
    from autograder.judge.bench.wire import JudgeFailed
    from autograder.judge.serving import domain
    from autograder.judge.subjects.command_subject import CommandSubject
    from autograder.judge.verdicts import reference, trial

    try:
        expected = reference.load(exercise.id)
        with domain.lease() as domain_id:
            subject = CommandSubject(as_run(exercise, command, cwd), cwd, box)
            checked = trial.check(exercise, subject, expected, seed=seed, domain_id=domain_id)
            return checked.verdict, checked
    except (domain.NoFreeDomainError, reference.NoReference, JudgeFailed) as error:
        return not_checked(exercise.id, exercise.title, exercise.points, str(error)), None
