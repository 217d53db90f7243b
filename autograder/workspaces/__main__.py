"""``python -m autograder.workspaces``: the command that a check runs when it is given a path.

It builds the packages in the workspace, reports the result, then becomes the student's program.

In a terminal, the check starts this command as a process; in a notebook, the kernel starts it when the judge asks. The
judge reads the output, in which the report on the build comes before any output of the student's program. Everything
runs with the student's rights on the student's own computer. When a class is graded, however,
`autograder.workspaces.grading_service` does this work instead.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.kit.output.workspace_reports import failed_line
from autograder.kit.runners import Launches, LaunchesFromPackage, RunsPrograms, runner_from_word
from autograder.process_trees import die_with_parent
from autograder.workspaces.builds.students_builds import StudentsBuilds
from autograder.workspaces.launch_watching import watched
from autograder.workspaces.packages import workspace_of
from autograder.workspaces.program_plans import plan_for, ros2, single_program_command
from autograder.workspaces.program_preparation import Preparation

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.workspaces.program_preparation import Prepared


def main(arguments: Sequence[str]) -> int:
    """Run ``python -m autograder.workspaces RUNNER PATH``, or ``RUNNER -- COMMAND`` for a launch command.

    RUNNER is an exercise's id or, in a box, which sees no exercises, the exercise's runner
    (:func:`autograder.kit.runners.runner_as_word`). If an exercise has several programs, the path is followed by the
    name of one of them. If the exercise is about a launch, the path may be followed by ``--alone`` and the name of a
    program to run instead of the launch. The exit code is returned.
    """
    die_with_parent(number=signal.SIGTERM)
    try:
        return _run_subject(*arguments)
    except Exception as error:
        print_line(failed_line(error))
        return 2


def _run_subject(word: str, *rest: str) -> int:
    runner = runner_from_word(word) if word.startswith("[") else exercises.get(word).runner
    if isinstance(runner, Launches):
        return _launch(rest)
    launches = isinstance(runner, LaunchesFromPackage)
    several = isinstance(runner, RunsPrograms)
    if runner is None or (len(rest) > 1 and not launches) != several:
        print(f"{word} takes no path: give it the class or function, or a command", file=sys.stderr)
        return 2
    here = Preparation(StudentsBuilds(), print_line)
    prepared = here.workspace(plan_for(runner, rest[1:]), Path(rest[0]))
    if prepared is not None and launches:
        return _run(prepared)
    if prepared is not None:
        os.execvpe(prepared.command[0], list(prepared.command), prepared.environment)
    return 1


def _launch(rest: Sequence[str]) -> int:
    here = Preparation(StudentsBuilds(), print_line)
    if rest[0] == "--":
        prepared = here.launch(single_program_command(rest) or rest[1:], None, None)
    elif not (file := Path(rest[0])).is_file():
        print(f"there is no launch file {file}", file=sys.stderr)
        return 1
    else:
        workspace = workspace_of(file, (file.resolve().parent, Path.cwd()))
        prepared = here.launch(single_program_command(rest) or [ros2(), "launch", rest[0]], file, workspace)
    return _run(prepared) if prepared else 1


def _run(launch: Prepared) -> int:
    """Run a launch to its end, and report the processes that it starts. Return its exit code.

    On the wire, a topic that was renamed in the code looks like a topic that the launch file remaps. The reported
    command lines tell the two apart, because a launch passes a remapping on a node's command line.
    """
    # Ignore Ctrl-C in this process, which has to wait for the launch. The launch also gets Ctrl-C, and ends its nodes
    # and itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    process = subprocess.Popen(launch.command, env=launch.environment, preexec_fn=_listen_to_interrupts)
    signal.signal(signal.SIGTERM, lambda *_: process.terminate())
    # Start each report on a new line, because the launch may have written only part of a line.
    with watched(process.pid, lambda line: print_line(f"\n{line}")):
        return process.wait()


def _listen_to_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def print_line(line: str) -> None:
    """Print a line in one write, so that other output to the same pipe cannot come in between."""
    os.write(1, f"{line}\n".encode("utf-8", "replace"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
