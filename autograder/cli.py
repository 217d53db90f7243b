"""The ``autograder`` command. Thin: each command hands over to the part that does the work.

Exit codes: 0 all is well, 1 the answer is no (a failed check, stale notebooks), 2 it could not be done (bad
input, or trouble of the grader's own). Imports are inside the commands: ``check`` must answer at once.
"""

from __future__ import annotations

import sys
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from autograder.progress import commands

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.boxes.one_command import OneCommandBox
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
@click.option(
    "--box", "boxed", is_flag=True, help="Run COMMAND in a box as a class would: it sees this folder only."
)
def check(
    exercise: str | None, command: tuple[str, ...], as_json: bool, seed: str | None, boxed: bool
) -> None:
    """Run any COMMAND as the subject of EXERCISE and print the verdict.

    \b
    autograder check                               lists the exercises
    autograder check lab_1_2.talker -- python3 talker.py
    autograder check lab_1_2.talker --box -- python3 talker_of_somebody_else.py

    Exit code 0: passed; 1: not passed; 2: could not be checked.
    """  # noqa: D301 (to click, the backspace keeps the lines below it apart)
    from autograder import exercises

    if exercise is None:
        list_exercises()
        return
    try:
        wanted = exercises.get(exercise)
    except (exercises.UnknownExercise, exercises.BrokenExercise) as error:
        fail(str(error))
    if not command:
        fail(
            f"say which command to check, after two dashes: autograder check {exercise} -- python3 my_file.py"
            + (f" (it is called with {wanted.arguments})" if wanted.arguments else "")
        )
    from autograder.judge.subjects.command import CommandNotFound, check_command

    try:
        with _box(command) if boxed else nullcontext() as box:
            verdict = check_command(exercise, command, seed=seed, box=box)
    except CommandNotFound as error:
        fail(str(error))
    if not boxed:  # what somebody else wrote is no progress of the user's
        from autograder import journal

        journal.note_check(verdict)
    show(verdict, as_json=as_json)
    sys.exit({"passed": 0, "failed": NO}.get(verdict.state, CANNOT))


@contextmanager
def _box(command: Sequence[str]) -> Iterator[OneCommandBox]:
    import tempfile
    from contextlib import closing

    from autograder.boxes.one_command import OneCommandBox
    from autograder.boxes.sandbox import why_impossible

    why = why_impossible()
    if why:
        fail(f"no box is possible here: {why}")
    with tempfile.TemporaryDirectory(prefix="box-") as scratch:
        try:
            box = OneCommandBox(Path(scratch), Path.cwd(), command)
        except ValueError as error:
            fail(str(error))
        with closing(box):
            yield box


def list_exercises() -> None:
    """One line for each exercise: id, points, what is asked for."""
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


@cli.command("new-exercise")
@click.argument("exercise")
@click.option("--recipe", default="publisher", show_default=True, help="The kind of subject that it judges.")
@click.option("--chapter", help="The folder of its chapter in solutions/; the last one where not given.")
def new_exercise(exercise: str, recipe: str, chapter: str | None) -> None:
    """Make the folder of a new lab with one EXERCISE that works, for you to change.

    \b
    autograder new-exercise lab_9_1.battery --recipe publisher
    """  # noqa: D301 (to click, the backspace keeps the lines below it apart)
    from autograder import course
    from autograder.authoring import new_exercise as making

    root = course.root()
    try:
        made = making.new_exercise(root, exercise, recipe, chapter=chapter)
    except (making.CannotMake, course.BrokenChapter) as error:
        fail(str(error))
    for file in made:
        click.echo(f"written    {file.relative_to(root)}")
    click.echo(f"\nNow: ./course try-exercise {exercise}")


@cli.command("try-exercise")
@click.argument("exercise")
@click.option(
    "--only", multiple=True, help="Only answers with this in their names; may be given several times."
)
@click.option("--jobs", type=click.IntRange(min=1), default=4, show_default=True, help="Answers at once.")
def try_exercise(exercise: str, only: tuple[str, ...], jobs: int) -> None:
    """Record EXERCISE where it is new, judge its right and wrong answers, and show what is not as expected."""
    from autograder import exercises, masters, recording
    from autograder.authoring import trying
    from autograder.authoring.answer_tables import BadTable

    try:
        fits = trying.try_exercise(exercise, only=only, jobs=jobs, tell=click.echo)
    except (
        BadTable,
        exercises.BrokenExercise,
        exercises.UnknownExercise,
        masters.MasterError,
        recording.CannotRecord,
        trying.NothingToTry,
    ) as error:
        fail(str(error))
    sys.exit(0 if fits else NO)


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
        open_lab(folder or course.root() / course.CHAPTERS, arguments)
    except (NoSuchFolderError, NoFreeDomainError, ValueError) as error:
        fail(str(error))


cli.add_command(commands.progress)
cli.add_command(commands.reset)


@cli.command("hand-out")
@click.argument("place", type=click.Path(path_type=Path))
@click.option("--zip", "as_zip", is_flag=True, help="Make PLACE a zip file.")
def hand_out(place: Path, as_zip: bool) -> None:
    """Make in PLACE what a class is handed: notebooks and judge, no solution, no answer, no grader."""
    from autograder import course, handing_out

    try:
        made = handing_out.hand_out(place, course.root(), as_zip=as_zip)
    except (handing_out.CannotHandOut, OSError) as error:
        fail(str(error))
    click.echo(
        f"{made.place}: {made.files} files, {made.size / 1e6:.1f} MB. Try it: ./course lab, in that folder"
    )


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


@cli.command("renew-class")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--assignment", "assignments", multiple=True, help="Only this assignment; may be given several times."
)
def renew_class(folder: Path, assignments: tuple[str, ...]) -> None:
    """Bring the sources of the class FOLDER to what the course says now; the old ones are kept."""
    from autograder import course, grading

    with grading_errors():
        for line in grading.renew_class(folder, course.root(), assignments=assignments):
            click.echo(line)


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--assignment", default="", help="What all of it is for; told from names and contents where not given."
)
@click.option(
    "--timezone", default="", metavar="Europe/Berlin", help="Of times in names and lists; this machine's."
)
@click.option(
    "--from",
    "form",
    type=click.Choice(["moodle", "canvas", "blackboard", "brightspace", "google", "github"]),
    default=None,
    help="Which system it is from; told from the names where not given.",
)
def collect(folder: Path, files: tuple[Path, ...], assignment: str, timezone: str, form: str | None) -> None:
    """Put FILES that an LMS let you download into the class directory FOLDER.

    FILES are zips, folders and notebooks of Moodle, Canvas, Blackboard, Brightspace, Google Classroom or GitHub
    Classroom, and lists (.csv) that come with them. Whose they are says students.csv in FOLDER.

    Exit code 0: everything has its place; 2: the lines say what has not, and why.
    """
    from autograder import grading

    with grading_errors():
        report = grading.collect(folder, files, assignment=assignment, timezone=timezone, form=form or "")
    sys.exit(report.exit_code)


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
@click.option(
    "--dry-run", is_flag=True, help="Enter nothing: run what has changed and say who would get other points."
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
    dry_run: bool,
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
                dry_run=dry_run,
                as_json=as_json,
            )
    except KeyboardInterrupt:
        click.echo(
            "autograder: stopped. What was graded is kept; the same command goes on from there.", err=True
        )
        sys.exit(INTERRUPTED)
    sys.exit(report.exit_code)


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--to", type=click.Choice(["canvas", "moodle", "csv", "xlsx"]), required=True, help="Whose form."
)
@click.option(
    "--assignment", "assignments", multiple=True, help="Only this assignment; may be given several times."
)
@click.option(
    "--into", type=click.Path(path_type=Path), help="Fill in this list, as Moodle or Canvas has exported it."
)
@click.option(
    "--output", type=click.Path(path_type=Path), help="Where to write; FOLDER/export where not given."
)
def export(
    folder: Path, to: str, assignments: tuple[str, ...], into: Path | None, output: Path | None
) -> None:
    """Write the gradebook's points, and the feedback as a zip, in the form that an LMS takes."""
    from autograder import grading

    with grading_errors():
        grading.export_points(folder, to, assignments=assignments, into=into, folder=output)


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--without-names", is_flag=True, help="Call students by numbers, without links to their pages.")
@click.option(
    "--output", type=click.Path(path_type=Path), help="The page; FOLDER/report.html where not given."
)
def report(folder: Path, without_names: bool, output: Path | None) -> None:
    """Write one page about the class FOLDER: points, mistakes, exercises, who is where."""
    from autograder import grading

    with grading_errors():
        click.echo(grading.write_report(folder, names=not without_names, to=output))


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("assignment", required=False, default="")
@click.option(
    "--output", type=click.Path(path_type=Path), help="The page; FOLDER/similar.html where not given."
)
def similar(folder: Path, assignment: str, output: Path | None) -> None:
    """Find pairs of submissions in the class FOLDER that are closer than the task explains.

    A pair is a hint, not a proof. Only ASSIGNMENT is looked at where it is named.

    Exit code 0: all was compared; 2: the lines say what was not, and why.
    """
    from autograder import grading

    with grading_errors():
        found = grading.similar(folder, assignment, to=output)
    sys.exit(found.exit_code)


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("before", required=False, default="")
@click.argument("after", required=False, default="")
def compare(folder: Path, before: str, after: str) -> None:
    """Say who has other points after the last run of the class FOLDER than before it.

    BEFORE and AFTER are runs, by the times in the first line that this prints.
    """
    from autograder import grading

    with grading_errors():
        for line in grading.compare(folder, before, after):
            click.echo(line)


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("student")
def attempts(folder: Path, student: str) -> None:
    """Say what came of each time that STUDENT was graded in the class FOLDER."""
    from autograder import grading

    with grading_errors():
        for line in grading.attempts_of(folder, student):
            click.echo(line)


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
