"""The ``autograder`` command. Thin: each command hands over to the part that does the work.

Exit codes: 0 all is well, 1 the answer is no (a failed check, stale notebooks), 2 it could not be done (bad
input, or trouble of the grader's own). Imports are inside the commands: ``check`` must answer at once.
"""

from __future__ import annotations

import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.verdict import Verdict

NO = 1
CANNOT = 2
INTERRUPTED = 130
"""What a shell says of a program that Ctrl-C ended: 128 and the signal's number."""


def fail(message: str) -> NoReturn:
    """End with a clear error and exit code 2."""
    click.echo(f"autograder: {message}", err=True)
    sys.exit(CANNOT)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="ros2-course-autograder", prog_name="autograder")
def cli() -> None:
    """Check ROS 2 exercises on the wire, build the notebooks, grade a class."""


@cli.command()
@click.argument("exercise", required=False)
@click.argument("command", nargs=-1, type=click.UNPROCESSED)
@click.option("--json", "as_json", is_flag=True, help="Print the verdict as one JSON object.")
@click.option("--seed", help="Draw the random inputs from this: the same seed gives the same inputs.")
def check(exercise: str | None, command: tuple[str, ...], as_json: bool, seed: str | None) -> None:
    """Run any COMMAND as the subject of EXERCISE and print the verdict.

    \b
    autograder check                               lists the exercises
    autograder check lab_1_2.talker -- python3 talker.py

    Exit code 0: passed; 1: not passed; 2: could not be checked.
    """  # noqa: D301 (to click, the backspace keeps the lines below it apart)
    from autograder import exercises

    if exercise is None:
        list_exercises()
        return
    try:
        wanted = exercises.get(exercise)
    except exercises.UnknownExercise as error:
        fail(str(error))
    if not command:
        fail(
            f"say which command to check, after two dashes: autograder check {exercise} -- python3 my_file.py"
            + (f" (it is called with {wanted.arguments})" if wanted.arguments else "")
        )
    from autograder.judge.command import CommandNotFound, check_command

    try:
        verdict = check_command(exercise, command, seed=seed)
    except CommandNotFound as error:
        fail(str(error))
    show(verdict, as_json=as_json)
    sys.exit({"passed": 0, "failed": NO}.get(verdict.state, CANNOT))


def list_exercises() -> None:
    """One line for each exercise: id, points, what is asked for."""
    from autograder import exercises

    for exercise_id in exercises.all_ids():
        exercise = exercises.get(exercise_id)
        click.echo(f"{exercise_id:<26} {exercise.points:>3g} points  {exercise.task}")


def show(verdict: Verdict, *, as_json: bool) -> None:
    """Print a verdict as a card or as JSON."""
    if as_json:
        from autograder.verdict import to_json

        click.echo(to_json(verdict).decode())
        return
    from autograder.cards.text import card_text

    click.echo(card_text(verdict, color=sys.stdout.isatty()))


@cli.command()
@click.option(
    "--check", "only_check", is_flag=True, help="Write nothing; fail where a notebook is out of step."
)
def build(only_check: bool) -> None:
    """Derive the chapter notebooks from their masters."""
    from autograder import course, masters

    sys.exit(masters.build_command(course.root(), check=only_check))


@cli.command()
@click.argument("notebooks", nargs=-1, metavar="[NOTEBOOK]...")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    help="Notebooks at once; as many as load and memory allow where not given.",
)
@click.option(
    "--reports", type=click.Path(path_type=Path), help="Keep the pages about failed notebooks in this folder."
)
def execute(notebooks: tuple[str, ...], jobs: int | None, reports: Path | None) -> None:
    """Run every notebook: masters must earn full marks, chapters none, without an error."""
    from autograder import course, masters
    from autograder.execution import NothingToExecuteError, execute_command

    try:
        sys.exit(execute_command(course.root(), only=notebooks, jobs=jobs, reports=reports))
    except (NothingToExecuteError, masters.MasterError) as error:
        fail(str(error))


@cli.command()
@click.argument("exercises", nargs=-1, metavar="[EXERCISE]...")
@click.option("--check", "only_check", is_flag=True, help="Write nothing; fail where a recording differs.")
def record(exercises: tuple[str, ...], only_check: bool) -> None:
    """Record what the reference solutions do on the wire: the grader expects that from then on."""
    from autograder import recording

    try:
        changed = recording.record(exercises, only_check=only_check, tell=click.echo)
    except recording.CannotRecord as error:
        fail(str(error))
    sys.exit(NO if only_check and changed else 0)


@cli.command()
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
def doctor(as_json: bool) -> None:
    """Say what is there, what is missing and how to get it."""
    from autograder import course

    sys.path.insert(0, str(course.root()))
    from environment import doctor as probes

    sys.exit(probes.main(["--json"] if as_json else []))


@cli.command(context_settings={"ignore_unknown_options": True})
@click.option(
    "--folder", type=click.Path(path_type=Path), help="Open this folder of notebooks instead of the chapters."
)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[JUPYTERLAB'S OPTIONS]...")
def lab(folder: Path | None, arguments: tuple[str, ...]) -> None:
    """Open JupyterLab on the chapters, with a ROS domain of its own."""
    from autograder import course
    from autograder.lab import NoSuchFolderError, open_lab
    from autograder.ros_domain import NoFreeDomainError

    try:
        open_lab(folder or course.root() / "chapters", arguments)
    except (NoSuchFolderError, NoFreeDomainError, ValueError) as error:
        fail(str(error))


@cli.command("new-class")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--assignment", "assignments", multiple=True, help="Only this assignment; may be given several times."
)
def new_class(folder: Path, assignments: tuple[str, ...]) -> None:
    """Make an nbgrader course directory in FOLDER, ready for submissions."""
    from autograder import course, grading

    with grading_errors():
        made = grading.new_class(folder, course.root(), assignments=assignments)
    click.echo(made.summary())


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--assignment", "assignments", multiple=True, help="Only this assignment; may be given several times."
)
@click.option("--student", "students", multiple=True, help="Only this student; may be given several times.")
@click.option("--again", is_flag=True, help="Run unchanged submissions again.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    help="Notebooks at once; as many as load and memory allow where not given.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object.")
@click.option(
    "--unsafe-no-sandbox",
    is_flag=True,
    help="Run submissions with all your rights where no sandbox is possible. They could change any grade.",
)
@click.option(
    "--scheduler",
    metavar="tcp://HOST:PORT",
    help="Have the workers of this Dask scheduler run the submissions (see `autograder worker`).",
)
def grade(
    folder: Path,
    assignments: tuple[str, ...],
    students: tuple[str, ...],
    again: bool,
    jobs: int | None,
    as_json: bool,
    unsafe_no_sandbox: bool,
    scheduler: str | None,
) -> None:
    """Grade what was submitted in the class directory FOLDER."""
    from autograder import grading

    if scheduler is not None and jobs is not None:
        fail("--jobs is for this machine; each worker of a cluster has its own: autograder worker --jobs")
    try:
        with grading_errors():
            report = grading.grade(
                folder,
                assignments=assignments,
                students=students,
                again=again,
                jobs=jobs,
                unsafe_no_sandbox=unsafe_no_sandbox,
                scheduler=scheduler,
                as_json=as_json,
            )
    except KeyboardInterrupt:
        click.echo(
            "autograder: stopped. What was graded is kept; the same command goes on from there.", err=True
        )
        sys.exit(INTERRUPTED)
    sys.exit(report.exit_code)


@cli.command()
@click.argument("scheduler", required=False, metavar="[tcp://HOST:PORT]")
@click.option(
    "--jobs", type=click.IntRange(min=1), help="Submissions at once; as many as cores where not given."
)
@click.option("--name", help="What messages call this worker; host and process where not given.")
@click.option(
    "--unsafe-no-sandbox",
    is_flag=True,
    help="Also where no sandbox is possible. Submissions then run with all your rights.",
)
def worker(scheduler: str | None, jobs: int | None, name: str | None, unsafe_no_sandbox: bool) -> None:
    """Work for `autograder grade --scheduler`, until Ctrl-C or until the scheduler ends."""
    from autograder.grading.cluster import connection

    with grading_errors():
        connection.check_dask()
        from autograder.grading.cluster.start_worker import start_worker

        start_worker(scheduler, jobs=jobs, name=name, sandbox=not unsafe_no_sandbox, tell=click.echo)


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path), default=Path("demo-class"))
def demo(folder: Path) -> None:
    """Make a sample class, grade it and show the result."""
    from autograder import grading

    with grading_errors():
        report = grading.demo(folder)
    sys.exit(report.exit_code)


@contextmanager
def grading_errors() -> Iterator[None]:
    """Turn the grader's own errors into a clear line and exit code 2."""
    from autograder.grading.errors import GradingError

    try:
        yield
    except GradingError as error:
        fail(str(error))
