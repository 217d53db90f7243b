"""The commands for authors: build, execute and record the course, and add an exercise."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from autograder.cli.class_options import jobs_option
from autograder.cli.command_results import NO, fail, failing_with, need_ros, use_own_interfaces
from autograder.command_name import COMMAND


@click.command()
@click.option("--check", "only_check", is_flag=True, help="Write nothing; fail if a notebook is out of date.")
def build(only_check: bool) -> None:
    """Build the chapter notebooks from their masters."""
    from autograder import course
    from autograder.masters.chapter_building import build_command

    sys.exit(build_command(course.root(), check=only_check))


@click.command()
@click.argument("notebooks", nargs=-1, metavar="[NOTEBOOK]...")
@jobs_option
def execute(notebooks: tuple[str, ...], jobs: int | None) -> None:
    """Run every notebook: masters must earn full marks. Students' notebooks must earn no points and cause no error."""
    from autograder import course
    from autograder.authoring.notebook_execution import NothingToExecuteError, execute_command
    from autograder.masters.master_files import MasterError

    need_ros()
    use_own_interfaces()
    with failing_with(NothingToExecuteError, MasterError):
        sys.exit(execute_command(course.root(), only=notebooks, jobs=jobs))


@click.command()
@click.argument("exercises", nargs=-1, metavar="[EXERCISE]...")
@click.option(
    "--check",
    "only_check",
    is_flag=True,
    help="Write nothing; fail if a solution now does something different from its recording.",
)
def record(exercises: tuple[str, ...], only_check: bool) -> None:
    """Record what the reference solutions do on the wire. The grader compares answers with the recordings.

    Then the mutants of each solution are tried on paper: the drawings have to tell them, and the cards of students name
    what the mutants do.
    """
    from autograder.authoring import exercise_trial, reference_files
    from autograder.exercises import BrokenExercise, UnknownExercise, all_ids, get

    need_ros()
    use_own_interfaces()
    with failing_with(BrokenExercise, UnknownExercise, reference_files.CannotRecord):
        wanted = [get(exercise_id) for exercise_id in exercises or all_ids()]
        changed = reference_files.record(wanted, only_check=only_check, tell=click.echo)
    if only_check:
        sys.exit(NO if changed else 0)
    tried = [exercise_trial.try_mutants(one, keeps=True, tell=click.echo) for one in wanted]
    sys.exit(0 if all(tried) else NO)


@click.command("new-exercise")
@click.argument("exercise")
@click.option(
    "--recipe",
    default="publisher",
    show_default=True,
    help="The kind of program or notebook code that the exercise judges.",
)
@click.option(
    "--chapter", help="The folder of the exercise's chapter in solutions/. The default is the last chapter."
)
@click.option("--lab", "to_lab", is_flag=True, help="Add the exercise to its lab, which already exists.")
def new_exercise(exercise: str, recipe: str, **choices: Any) -> None:
    """Make the folder of a new lab with one working EXERCISE, which you then change.

    \b
    new-exercise lab_8_1.battery --recipe publisher
    """  # noqa: D301 (to click, the backspace keeps the lines below it apart)
    from autograder import course
    from autograder.authoring import new_exercise as making

    root = course.root()
    with failing_with(making.CannotMake, course.BrokenChapter):
        made = making.new_exercise(root, exercise, recipe, **choices)
    for file in made:
        click.echo(f"written    {file.relative_to(root)}")
    click.echo(f"\nNow: {COMMAND} try-exercise {exercise}")


@click.command("try-exercise")
@click.argument("exercise")
@click.option(
    "--only",
    multiple=True,
    help="Judge only answers whose names contain this text; may be given several times.",
)
@click.option("--jobs", type=click.IntRange(min=1), default=4, show_default=True, help="Answers at once.")
@click.option(
    "--repeat",
    type=click.IntRange(min=1),
    default=1,
    help="Judge each answer this many times, each time with different random inputs.",
)
@click.option(
    "--transcript",
    type=click.Path(path_type=Path, file_okay=False),
    callback=lambda _context, _option, folder: folder and folder.absolute(),
    help="Write what the judge saw of each answer into this folder.",
)
@click.option(
    "--mutants", "only_mutants", is_flag=True, help="Try only the mutants of the solution, recorded or not."
)
@click.option("--judge", is_flag=True, help="With --mutants: the judge checks those that paper cannot run.")
def try_exercise(exercise: str, only_mutants: bool, judge: bool, **choices: Any) -> None:
    """Record EXERCISE if it is new, judge its sample answers, right and wrong, and show unexpected results."""
    from autograder import exercises
    from autograder.authoring import exercise_trial, reference_files
    from autograder.authoring.answer_tables import BadTable
    from autograder.masters.master_files import MasterError

    need_ros()
    use_own_interfaces()
    of_exercises = (exercises.BrokenExercise, exercises.UnknownExercise, exercise_trial.NothingToTry)
    with failing_with(*of_exercises, BadTable, MasterError, reference_files.CannotRecord):
        wanted = exercises.get(exercise)
        if only_mutants:
            fits = exercise_trial.try_mutants(
                wanted,
                by_judge=choices["jobs"] if judge else 0,
                must_be_recorded=False,
                tell=click.echo,
            )
        else:
            fits = exercise_trial.try_exercise(wanted, tell=click.echo, **choices)
    sys.exit(0 if fits else NO)


@click.command()
@click.option(
    "--to",
    "folder",
    type=click.Path(path_type=Path, file_okay=False),
    help="The folder to write the pages to. The default is site/.",
)
@click.option(
    "--quick", is_flag=True, help="Do not execute the notebooks, so that the pages show no outputs."
)
def site(folder: Path | None, quick: bool) -> None:
    """Make a website of the labs with folded solutions, and of the guides. It needs no server and no network."""
    from autograder import course
    from autograder.authoring.site_building import build_site

    root = course.root()
    folder = (folder or root / "site").absolute()
    if folder.exists() and any(folder.iterdir()) and not (folder / "searchindex.js").is_file():
        fail(f"{folder} contains files that are not part of a site: choose another folder with --to FOLDER")
    problems = build_site(root, folder, outputs=not quick, tell=click.echo)
    click.echo(f"written    {folder / 'index.html'}")
    if problems:
        click.echo(f"{problems} problems are listed above.", err=True)
    sys.exit(NO if problems else 0)


AUTHOR_COMMANDS = (build, execute, site, record, new_exercise, try_exercise)
