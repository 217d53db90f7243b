"""Run what is in a workspace as the subject of a check: build it, report, then become the student's program.

A terminal's check starts this as a process, a notebook does at the judge's word, and the judge reads what it prints.
What it reports about the build goes before everything that a program of the student's says. All of it runs with the
rights of the student, on the student's own computer; a class is graded by `autograder.workspaces.grading.service`
instead.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.kit.runners import Launches, RunsPrograms
from autograder.parent_death import die_with_parent
from autograder.workspaces.building.colcon import build, look
from autograder.workspaces.running.launching import launch
from autograder.workspaces.running.plans import plan_for, ros2
from autograder.workspaces.running.prefixes import with_prefixes
from autograder.workspaces.running.processes import tell
from autograder.workspaces.running.reporting import built_line, found_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.workspaces.running.plans import Plan


def main(arguments: Sequence[str]) -> int:
    """``python -m autograder.workspaces EXERCISE PATH``, or ``EXERCISE -- COMMAND`` for a launch command.

    Where an exercise is about several programs, the path is followed by the name of one.
    """
    exercise = exercises.get(arguments[0])
    die_with_parent(number=signal.SIGTERM)
    if isinstance(exercise.runner, Launches):
        return _launch(arguments[1:])
    if exercise.runner is None or (len(arguments) > 2) != isinstance(exercise.runner, RunsPrograms):
        print(f"{exercise.id} takes no path: give it the class or function, or a command", file=sys.stderr)
        return 2
    return run(plan_for(exercise.runner, arguments[2:]), Path(arguments[1]))


def run(plan: Plan, workspace: Path) -> int:
    """Report what is there, build what the exercise needs, report, and become the program.

    Returns:
        An exit code, where there is nothing to become.
    """
    found = look(workspace)
    tell(found_line(found, plan))
    if found.trouble:
        tell(built_line(found, plan))
        return 1
    made = build(workspace, plan.targets)
    missing = plan.missing(made) if made.ok else ""
    tell(built_line(made, plan, missing))
    if not made.ok or missing:
        return 1
    command = plan.command(made)
    os.execvpe(command[0], list(command), with_prefixes(os.environ, made.prefixes))
    return 1


def _launch(rest: Sequence[str]) -> int:
    if rest[0] == "--":
        return launch(rest[1:], None)
    if not Path(rest[0]).is_file():
        print(f"there is no launch file {rest[0]}", file=sys.stderr)
        return 1
    return launch([ros2(), "launch", rest[0]], Path(rest[0]))
