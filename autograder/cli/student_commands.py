"""The commands for students: check a program, open JupyterLab, show progress, reset a notebook, check the setup."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager, nullcontext, redirect_stderr
from pathlib import Path
from typing import TYPE_CHECKING

import click

from autograder.cli.command_results import (
    CANNOT,
    NO,
    as_json_option,
    fail,
    failing_with,
    need_ros,
    print_json,
    use_own_interfaces,
)
from autograder.command_name import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.boxes.sandbox import OneCommandBox
    from autograder.kit.model import Exercise
    from autograder.verdict import Verdict


_notebooks = click.option(
    "--folder", type=click.Path(path_type=Path), help="The folder of your notebooks. The default is chapters."
)


@click.command(
    help=f"""Check the program that COMMAND starts against EXERCISE and print the verdict.

    \b
    {COMMAND} check                                       lists the exercises
    {COMMAND} check EXERCISE -- python3 my_program.py
    {COMMAND} check EXERCISE --box -- python3 program_of_another_person.py

    Exit code 0: passed; 1: not passed; 2: could not be checked."""
)
@click.argument("exercise", required=False)
@click.argument("command", nargs=-1, type=click.UNPROCESSED)
@as_json_option
@click.option("--seed", help="The seed of the random inputs. The same seed gives the same inputs.")
@click.option(
    "--box",
    "boxed",
    is_flag=True,
    help="Run COMMAND in the sandbox in which submissions of a class run. It can read only the current folder.",
)
def check(
    exercise: str | None, command: tuple[str, ...], as_json: bool, seed: str | None, boxed: bool
) -> None:
    """Run a command as the subject of an exercise and print the verdict."""
    from autograder import course, exercises

    # If the current folder is in a course, the code of that course judges the program. With --box the program's author
    # is not trusted, and the author may have changed the code of the course, too. So the installed package judges.
    if not boxed:
        course.use_the_one_around(Path.cwd())
    if exercise is None:
        _list_exercises()
        return
    with failing_with(exercises.UnknownExercise, exercises.BrokenExercise):
        wanted = exercises.get(exercise)
    if not command:
        fail(
            f"no command to check: write it after two dashes, such as {COMMAND} check {exercise} -- python3 my_file.py"
            + (f" (it is called with {wanted.arguments})" if wanted.arguments else "")
        )
    need_ros()
    use_own_interfaces()
    from autograder.judge.command_check import CommandNotFound, check_and_keep
    from autograder.standard_output import stray_lines_on_stderr

    # Otherwise nothing is shown for up to half a minute, and in a pipe this looks like a program that hangs.
    click.echo(
        f"autograder: judging {exercise}: a right answer takes about 5 s, a wrong one up to 30 s", err=True
    )
    box_or_none = _box(wanted, command) if boxed else nullcontext()
    with failing_with(CommandNotFound), box_or_none as box, stray_lines_on_stderr():
        verdict, _ = check_and_keep(exercise, command, seed=seed, box=box)
    # A program of another person, or a solution that the course brings, does not count as the user's progress.
    if not boxed and _is_students(command):
        from autograder import check_journal

        check_journal.note_check(verdict)
    show(verdict, as_json=as_json)
    sys.exit({"passed": 0, "failed": NO}.get(verdict.state, CANNOT))


def _is_students(command: Sequence[str]) -> bool:
    """Return True if the command names a file in the folder of the student's notebooks, or none and is typed there."""
    from autograder import course

    try:
        notebooks, _ = _notebooks_and_journal(course.root(), None)
    except course.NoCourse:
        return False
    files = [Path(word).resolve() for word in command if Path(word).is_file()]
    return any(place.is_relative_to(notebooks.resolve()) for place in files or [Path.cwd()])


@contextmanager
def _box(exercise: Exercise, command: Sequence[str]) -> Iterator[OneCommandBox]:
    from contextlib import closing

    from autograder import course
    from autograder.boxes.sandbox import OneCommandBox, why_impossible
    from autograder.kit.runners import Launches, LaunchesFromPackage
    from autograder.safe_files import HeldFolder
    from autograder.workspaces.program_plans import reference_workspace

    why = why_impossible()
    if why:
        fail(f"no sandbox is possible here: {why}")
    with HeldFolder("autograder-box-") as scratch:
        try:
            # A launch may start the course's own talker and listener.
            launches = isinstance(exercise.runner, Launches | LaunchesFromPackage)
            more = [own] if launches and (own := reference_workspace()).is_dir() else []
            box = OneCommandBox(scratch.path, Path.cwd(), command, more, course.variables())
        except ValueError as error:
            fail(str(error))
        with closing(box):
            yield box


def _list_exercises() -> None:
    """Print one line for each exercise: id, points and task."""
    from autograder import exercises

    for exercise_id in exercises.all_ids():
        try:
            exercise = exercises.get(exercise_id)
        except exercises.BrokenExercise as error:
            click.echo(f"autograder: {error}", err=True)
            continue
        click.echo(f"{exercise_id:<26} {exercise.points:>3g} points  {exercise.task}")


def show(verdict: Verdict, *, as_json: bool) -> None:
    """Print a verdict as a card or as JSON."""
    if as_json:
        print_json(verdict)
        return
    from autograder.cards.text_rendering import card_text
    from autograder.standard_output import styled

    click.echo(card_text(verdict, color=sys.stdout.isatty()), file=styled(sys.stdout))


@click.command(context_settings={"ignore_unknown_options": True})
@click.option(
    "--folder", type=click.Path(path_type=Path), help="Open this folder of notebooks instead of the chapters."
)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[JUPYTERLAB'S OPTIONS]...")
def lab(folder: Path | None, arguments: tuple[str, ...]) -> None:
    """Open JupyterLab with the course's notebooks, in a free ROS domain."""
    from autograder import course
    from autograder.dds_discovery import NoFreeDomainError
    from autograder.standard_output import styled
    from autograder.student.lab import NoSuchFolderError, open_lab

    use_own_interfaces()
    # JupyterLab colors its log itself.
    with failing_with(NoSuchFolderError, NoFreeDomainError, ValueError), redirect_stderr(styled(sys.stderr)):
        open_lab(folder or course.root() / course.CHAPTERS, arguments)


@click.command()
@_notebooks
def progress(folder: Path | None) -> None:
    """Show which points you have reached, and which task is next. This is not a grade."""
    from autograder import check_journal, course, exercises
    from autograder.student.progress import standing, standing_text

    with failing_with(course.NoCourse, course.BrokenChapter, exercises.BrokenExercise):
        root = course.root()
        notebooks, kept = _notebooks_and_journal(root, folder)
        found = standing(root, notebooks, check_journal.entries(kept))
    click.echo(standing_text(found))


@click.command()
@click.argument("notebook")
@_notebooks
def reset(notebook: str, folder: Path | None) -> None:
    """Replace NOTEBOOK, such as lab_1_2, by the original, and keep a copy of yours next to it."""
    from autograder import course
    from autograder.student import notebook_reset

    with failing_with(course.NoCourse, course.BrokenChapter, notebook_reset.CannotReset):
        root = course.root()
        notebooks, kept = _notebooks_and_journal(root, folder)
        done = notebook_reset.reset(root, notebooks, notebook, kept)
    click.echo(f"{done.notebook} is the original again.")
    if done.copy is not None:
        click.echo(f"Your notebook was copied to {done.copy}")


def _notebooks_and_journal(root: Path, folder: Path | None) -> tuple[Path, Path | None]:
    """Return the folder with the student's notebooks, and the path of the journal that records their checks."""
    from autograder import check_journal, course
    from autograder.student.lab import NOTEBOOKS_VARIABLE

    if folder is not None:
        return folder.resolve(), check_journal.journal_path(folder.resolve())
    session = os.environ.get(NOTEBOOKS_VARIABLE)
    return Path(session) if session else root / course.CHAPTERS, check_journal.session_journal_path()


@click.command()
@as_json_option
def doctor(as_json: bool) -> None:
    """Show what is installed, what is missing and how to install it."""
    from course_runtime import doctor as probes

    sys.exit(probes.main(["--json"] if as_json else []))


STUDENT_COMMANDS = (check, lab, progress, reset, doctor)
