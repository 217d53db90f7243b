"""The commands with which instructors make a class, collect submissions and grade them."""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from autograder.cli.class_options import (
    class_command,
    class_folder,
    from_option,
    into_columns,
    jobs_option,
    known_zone,
    names_option,
    one_assignment,
    only_assignments,
    only_sections,
    over_option,
    rename_option,
    student_option,
)
from autograder.cli.command_results import (
    INTERRUPTED,
    as_json_option,
    fail,
    failing_with,
    grading_errors,
    need_ros,
    print_json,
    print_line,
)
from autograder.command_name import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator
    from zoneinfo import ZoneInfo


@click.command("hand-out")
@click.argument("place", type=click.Path(path_type=Path))
@only_assignments
@click.option("--zip", "as_zip", is_flag=True, help="Make PLACE a zip file.")
@click.option(
    "--with-solutions",
    is_flag=True,
    help="Show the reference solution on cards with full marks, and offer it after the last hint and five failed "
    "checks. Students could then also read it earlier, in the folder exercises.",
)
def hand_out(place: Path, **choices: Any) -> None:
    """Make a hand-out for students in PLACE: notebooks and judge, without solutions, answers and grader."""
    from autograder import course
    from autograder.student import handout

    with failing_with(handout.CannotHandOut, OSError):
        made = handout.hand_out(place, course.root(), **choices)
    print_line(
        f"{made.place}: {made.files} files, {made.size / 1e6:.1f} MB. To try it, type in that folder: {COMMAND} lab"
    )


@click.command("new-class")
@class_folder
@only_assignments
@click.option(
    "--timezone",
    default="",
    callback=known_zone,
    metavar="Europe/Berlin",
    help="The time zone of due dates. The default is this machine's.",
)
def new_class(folder: Path, assignments: tuple[str, ...], timezone: ZoneInfo | None) -> None:
    """Make an nbgrader course directory in FOLDER, ready for submissions."""
    from autograder import course
    from autograder.grading.new_classes import new_class as classes

    with grading_errors():
        made = classes.new_class(folder, course.root(), assignments=assignments, timezone=str(timezone or ""))
    for line in made.summary():
        print_line(line)


@click.command("renew-class")
@class_folder
@only_assignments
def renew_class(folder: Path, assignments: tuple[str, ...]) -> None:
    """Update the source notebooks of the class FOLDER to the present course, and keep copies of the old ones."""
    from autograder import course
    from autograder.grading.new_classes.new_class import renew

    with grading_errors():
        for line in renew(folder, course.root(), assignments):
            print_line(line)


@class_command()
@class_folder
@click.argument("new_list", required=False, metavar="[LIST]", type=click.Path(path_type=Path))
@rename_option
@click.option(
    "--same-names",
    "by_name",
    is_flag=True,
    help="Students with the same name are the same students, for example in a list of another LMS.",
)
@click.option("--yes", is_flag=True, help="Make the changes. Without this option, they are only shown.")
def students(folder: Path, new_list: Path | None, said: dict[str, str], by_name: bool, yes: bool) -> None:
    """Show what a new list of students changes in the class FOLDER: the students renamed, dropped or added.

    LIST replaces students.csv in FOLDER; without it, students.csv itself is the new list. A student with a new id keeps
    work, points and records.
    """
    from autograder.grading.new_classes.changing_students import change_students

    with grading_errors():
        for line in change_students(folder, new_list, said, is_final=yes, by_name=by_name):
            print_line(line)


@class_command()
@class_folder
@click.argument("files", nargs=-1, type=click.Path(path_type=Path))
@one_assignment
@click.option(
    "--timezone",
    "zone",
    default="",
    callback=known_zone,
    metavar="Europe/Berlin",
    help="The time zone of times in file names and in lists of an LMS. The default is the time zone of the class.",
)
@from_option
@names_option
@student_option
@click.option(
    "--handed-in",
    default="",
    metavar="2026-01-31T12:00",
    help="The submission time of files for which no list and no file name gives one.",
)
@as_json_option
def collect(folder: Path, files: tuple[Path, ...], handed_in: str, as_json: bool, **choices: Any) -> None:
    """Put FILES that you downloaded from an LMS into the class directory FOLDER.

    FILES are zips, folders and notebooks of Moodle, Canvas, Blackboard, Brightspace, Sakai, ILIAS or Gradescope, or
    with names that --names describes, and the lists (.csv) that come with them. The file students.csv in FOLDER maps
    files to students.

    Exit code 0: every file was put into a submission; 2: some were not, and the printed lines say which and why.
    """
    from autograder.grading.collecting import collect as collecting
    from autograder.grading.collecting.collect import show
    from autograder.grading.collecting.written_times import read_time

    when = read_time(handed_in) if handed_in else None
    if handed_in and when is None:
        fail(f"--handed-in {handed_in} is not a time. A time looks like 2026-01-31T12:00.")
    with grading_errors():
        report = collecting.collect(folder, files, handed_in=when, **choices)
    if as_json:
        print_json(report)
    else:
        show(report)
    sys.exit(report.exit_code)


@contextlib.contextmanager
def _finished_grades_are_stored() -> Iterator[None]:
    """If Ctrl-C is pressed in the block, end the command with a sentence about what is stored."""
    try:
        yield
    except KeyboardInterrupt:
        click.echo(
            "autograder: stopped. Finished grades are stored; type the same command to grade the rest.",
            err=True,
        )
        sys.exit(INTERRUPTED)


@class_command()
@class_folder
@only_assignments
@click.option(
    "--student", "students", multiple=True, help="Grade only this student; may be given several times."
)
@only_sections
@click.option("--again", is_flag=True, help="Run unchanged submissions again.")
@jobs_option
@as_json_option
@click.option(
    "--unsafe-no-sandbox",
    is_flag=True,
    help="If no sandbox is possible on this machine, run submissions with all your rights. They could change grades.",
)
@click.option(
    "--scheduler",
    metavar="tcp://HOST:PORT",
    help=f"Have the workers of this Dask scheduler run the submissions (see `{COMMAND} worker`).",
)
@click.option(
    "--dry-run",
    is_flag=True,
    help="Change no grade: run submissions that are new or changed, and show whose points would change.",
)
@click.option(
    "--lower",
    type=click.Choice(["yes", "no"]),
    callback=lambda _context, _option, chosen: chosen or "",
    help="Take over points that fell although the same files were handed in, or keep the earlier points.",
)
def grade(folder: Path, as_json: bool, unsafe_no_sandbox: bool, **choices: Any) -> None:
    """Grade the submissions in the class directory FOLDER."""
    from autograder.grading import batch
    from autograder.grading.classes.class_directory import switch_sandbox_off
    from autograder.grading.reporting.grade_report import report_json, show

    if choices["scheduler"] is not None and choices["jobs"] is not None:
        fail(
            f"--jobs is only for this machine. In a cluster, set it for each worker: {COMMAND} worker --jobs"
        )
    if choices["scheduler"] is None:
        need_ros()
    if unsafe_no_sandbox:
        switch_sandbox_off(folder)
    with grading_errors(), _finished_grades_are_stored():
        report = batch.grade(folder, **choices)
    if as_json:
        print_json(report_json(report))
    else:
        show(report)
    sys.exit(report.exit_code)


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="DOWNLOAD [LIST]", type=click.Path(path_type=Path))
@click.option(
    "--class",
    "folder",
    default=Path(),
    type=click.Path(path_type=Path),
    help="The folder of the class. The default is the current folder.",
)
@one_assignment
@from_option
@names_option
@student_option
@into_columns
@over_option
def week(files: tuple[Path, ...], folder: Path, columns: dict[str, str], over: bool, **choices: Any) -> None:
    """Collect DOWNLOAD, grade it, and fill the points into LIST, in the folder of a class.

    DOWNLOAD is a zip or folder with submissions, as an LMS gives it. LIST is a list of the same LMS: Moodle's grading
    worksheet, or the exported gradebook, which is the list of students if the class has none. The filled list is in the
    folder export of the class. What waits for you comes last.

    Exit code 2: something waits.
    """
    from autograder.grading import week as weekly

    need_ros()
    with grading_errors(), _finished_grades_are_stored():
        chosen = weekly.WeekChoices(choices, columns=columns, over=over)
        report = weekly.week(folder.absolute(), files, chosen)
        weekly.show_week(report)
    sys.exit(report.exit_code)


@click.command()
@click.argument("scheduler", required=False, metavar="[tcp://HOST:PORT]")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    help="The number of submissions to run at the same time. The default is the number of cores.",
)
@click.option(
    "--name",
    help="The name of this worker in messages. The default consists of the host's name and the process id.",
)
@click.option(
    "--unsafe-no-sandbox",
    is_flag=True,
    help="Run submissions even if no sandbox is possible on this machine. The submissions then have all your rights.",
)
def worker(scheduler: str | None, unsafe_no_sandbox: bool, **choices: Any) -> None:
    """Run submissions for `grade --scheduler`, until you press Ctrl-C or the scheduler ends."""
    from autograder.grading.cluster.cluster_dispatcher import check_dask

    with grading_errors():
        check_dask()
        from autograder.grading.cluster.dask_worker import start_worker

        start_worker(scheduler, sandbox=not unsafe_no_sandbox, tell=click.echo, **choices)


@click.command()
@click.argument("folder", type=click.Path(path_type=Path), default=Path("demo-class"))
def demo(folder: Path) -> None:
    """Make a sample class of twenty students, grade it and write the page about it."""
    from autograder.grading.new_classes import sample_class

    with grading_errors():
        report = sample_class.demo(folder)
    sys.exit(report.exit_code)


CLASS_COMMANDS = (demo, hand_out, new_class, renew_class, students, week, collect, grade, worker)
