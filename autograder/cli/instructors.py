"""The commands of instructors: a class from handing out to returning."""

from __future__ import annotations

import sys
from pathlib import Path
from zoneinfo import ZoneInfo

import click

from autograder.cards.readable import printable, printable_json
from autograder.cli.ending import INTERRUPTED, fail, grading_errors
from autograder.kit.in_words import counted
from environment.installation import COMMAND

_class_folder = click.argument("folder", type=click.Path(path_type=Path))
_only_assignments = click.option(
    "--assignment", "assignments", multiple=True, help="Only this assignment; may be given several times."
)
_only_sections = click.option(
    "--section",
    "sections",
    multiple=True,
    help="Only students with this in the column section of students.csv.",
)


def _known_zone(_context: click.Context, _option: click.Parameter, name: str) -> ZoneInfo | None:
    """Return the time zone of that name; None if the option was not given."""
    try:
        return ZoneInfo(name) if name else None
    except (ValueError, OSError, LookupError):
        fail(f"There is no time zone {name!r}. A name looks like Europe/Berlin.")


@click.command("hand-out")
@click.argument("place", type=click.Path(path_type=Path))
@_only_assignments
@click.option("--zip", "as_zip", is_flag=True, help="Make PLACE a zip file.")
@click.option(
    "--with-solutions",
    is_flag=True,
    help="Show the reference solution on cards with full marks. Students can find it earlier, in the folder exercises.",
)
def hand_out(place: Path, assignments: tuple[str, ...], as_zip: bool, with_solutions: bool) -> None:
    """Make in PLACE the hand-out for a class: notebooks and judge, without solutions, answers and grader."""
    from autograder import course
    from autograder.student import handing_out

    try:
        made = handing_out.hand_out(
            place, course.root(), assignments=assignments, as_zip=as_zip, with_solutions=with_solutions
        )
    except (handing_out.CannotHandOut, OSError) as error:
        fail(str(error))
    click.echo(
        f"{made.place}: {made.files} files, {made.size / 1e6:.1f} MB. Try it: {COMMAND} lab, in that folder"
    )


@click.command("new-class")
@_class_folder
@_only_assignments
@click.option(
    "--timezone",
    default="",
    callback=_known_zone,
    metavar="Europe/Berlin",
    help="The time zone of due dates. The default is this machine's.",
)
def new_class(folder: Path, assignments: tuple[str, ...], timezone: ZoneInfo | None) -> None:
    """Make an nbgrader course directory in FOLDER, ready for submissions."""
    from autograder import course
    from autograder.grading.classes import new_class as classes

    with grading_errors():
        made = classes.new_class(folder, course.root(), assignments=assignments, timezone=str(timezone or ""))
    click.echo(made.summary())


@click.command("renew-class")
@_class_folder
@_only_assignments
def renew_class(folder: Path, assignments: tuple[str, ...]) -> None:
    """Update the sources of the class FOLDER to the present course; the old ones are kept."""
    from autograder import course
    from autograder.grading.classes.new_class import renew

    with grading_errors():
        for line in renew(folder, course.root(), assignments):
            click.echo(line)


_as_json = click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object.")


@click.command()
@_class_folder
@click.argument("files", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--assignment", default="", help="What all of it is for; told from names and contents where not given."
)
@click.option(
    "--timezone",
    default="",
    callback=_known_zone,
    metavar="Europe/Berlin",
    help="The time zone of times in names and lists; the time zone of the class by default.",
)
@click.option(
    "--from",
    "form",
    type=click.Choice(
        ["moodle", "canvas", "blackboard", "brightspace", "google", "github", "gradescope", "sakai", "ilias"]
    ),
    default=None,
    help="Which system it is from, if names do not show it. Google's and ILIAS's names are read only with it.",
)
@click.option(
    "--names",
    default="",
    metavar="'{id}-{last}_{assignment}'",
    help="What names say: id, email, login, number, name, first, last, assignment, time, file, any; or a column of "
    "students.csv.",
)
@click.option(
    "--handed-in",
    default="",
    metavar="2026-01-31T12:00",
    help="When that was, of which nothing else says it.",
)
@_as_json
def collect(
    folder: Path,
    files: tuple[Path, ...],
    assignment: str,
    timezone: ZoneInfo | None,
    form: str | None,
    names: str,
    handed_in: str,
    as_json: bool,
) -> None:
    """Put FILES that an LMS let you download into the class directory FOLDER.

    FILES are zips, folders and notebooks of Moodle, Canvas, Blackboard, Brightspace, Gradescope, Google Classroom or
    GitHub Classroom, and lists (.csv) that come with them. Whose they are says students.csv in FOLDER.

    Exit code 0: everything has its place; 2: the lines say what has not, and why.
    """
    import msgspec

    from autograder.grading.collecting import collect as collecting
    from autograder.grading.collecting.forms import read_time
    from autograder.grading.collecting.showing import show

    when = read_time(handed_in) if handed_in else None
    if handed_in and when is None:
        fail(f"--handed-in {handed_in} is no time. One looks like 2026-01-31T12:00.")
    with grading_errors():
        report = collecting.collect(
            folder, files, assignment=assignment, zone=timezone, form=form or "", names=names, handed_in=when
        )
    if as_json:
        click.echo(printable_json(msgspec.json.encode(report, enc_hook=str).decode()))
    else:
        show(report)
    sys.exit(report.exit_code)


@click.command()
@_class_folder
@_only_assignments
@click.option("--student", "students", multiple=True, help="Only this student; may be given several times.")
@_only_sections
@click.option("--again", is_flag=True, help="Run unchanged submissions again.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    help="Notebooks at once; as many as processors and memory allow where not given.",
)
@_as_json
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
    "--dry-run",
    is_flag=True,
    help="Change no grade: run what has changed and show whose points would change.",
)
def grade(
    folder: Path,
    assignments: tuple[str, ...],
    students: tuple[str, ...],
    sections: tuple[str, ...],
    again: bool,
    jobs: int | None,
    as_json: bool,
    unsafe_no_sandbox: bool,
    scheduler: str | None,
    dry_run: bool,
) -> None:
    """Grade the submissions in the class directory FOLDER."""
    from autograder.grading import batch
    from autograder.grading.running import sandboxing

    if scheduler is not None and jobs is not None:
        fail("--jobs is for this machine; each worker of a cluster has its own: autograder worker --jobs")
    if unsafe_no_sandbox:
        sandboxing.switch_off(folder)
    try:
        with grading_errors():
            report = batch.grade(
                folder,
                assignments=assignments,
                students=students,
                sections=sections,
                again=again,
                jobs=jobs,
                scheduler=scheduler,
                dry_run=dry_run,
            )
    except KeyboardInterrupt:
        click.echo(
            "autograder: stopped. What was graded is kept; the same command goes on from there.", err=True
        )
        sys.exit(INTERRUPTED)
    if as_json:
        from autograder.grading.reporting.report import report_json

        click.echo(printable_json(report_json(report).decode()))
    else:
        from autograder.grading.reporting.report_table import show

        show(report)
    sys.exit(report.exit_code)


@click.command()
@_class_folder
@click.option(
    "--to",
    type=click.Choice(
        ["canvas", "moodle", "gradescope", "blackboard", "brightspace", "sakai", "ilias", "csv", "xlsx"]
    ),
    required=True,
    help="Whose form.",
)
@_only_assignments
@_only_sections
@click.option(
    "--into",
    type=click.Path(path_type=Path),
    help="Fill in this list, as the system of --to has exported it.",
)
@click.option(
    "--column",
    "columns",
    multiple=True,
    metavar="ASSIGNMENT=COLUMN",
    help="What an assignment's column is called in --into; may be given several times.",
)
@click.option(
    "--absent",
    type=click.Choice(["blank", "zero"]),
    default="blank",
    help="The entry for students without a submission. The default is an empty cell.",
)
@click.option(
    "--output", type=click.Path(path_type=Path), help="The folder to write to. The default is FOLDER/export."
)
@_as_json
def export(
    folder: Path,
    to: str,
    assignments: tuple[str, ...],
    sections: tuple[str, ...],
    into: Path | None,
    columns: tuple[str, ...],
    absent: str,
    output: Path | None,
    as_json: bool,
) -> None:
    """Write the points and the feedback (as a zip) in the format that an LMS imports."""
    from autograder.grading.exporting.export_files import export as write_files

    pairs = (one.partition("=") for one in columns)
    named = {name.strip(): called.strip() for name, _, called in pairs}
    if not all(named.values()):
        fail('--column is an assignment and what its column is called: --column "ASSIGNMENT=COLUMN"')
    with grading_errors():
        done = write_files(
            folder,
            to,
            assignments=assignments,
            into=into,
            folder=output,
            absent_zero=absent == "zero",
            columns=named,
            sections=sections,
        )
    if as_json:
        import msgspec

        files = [{"path": str(file), "purpose": purpose} for file, purpose in done.files]
        said = msgspec.json.encode({"files": files, "notices": done.notices})
        click.echo(printable_json(said.decode()))
        return
    for file, purpose in done.files:
        click.echo(f"{printable(str(file))}\n    {printable(purpose)}")
    for notice in done.notices:
        click.echo(f"note: {printable(notice)}")


@click.command()
@_class_folder
@_only_sections
@click.option("--without-names", is_flag=True, help="Call students by numbers, without links to their pages.")
@click.option(
    "--output", type=click.Path(path_type=Path), help="The page to write. The default is FOLDER/report.html."
)
@_as_json
def report(
    folder: Path, sections: tuple[str, ...], without_names: bool, output: Path | None, as_json: bool
) -> None:
    """Write one page about the class FOLDER: points, mistakes, exercises and each student's progress."""
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.report_page.page import write_report
    from autograder.grading.reporting.report import table_json
    from autograder.grading.table.class_table import read_table

    if as_json and without_names:
        fail("--json has the ids of students: leave out --json or --without-names.")
    with grading_errors():
        page = write_report(folder, names=not without_names, to=output, sections=sections)
        said = table_json(page, read_table(ClassDirectory(folder), sections)) if as_json else b""
    click.echo(printable_json(said.decode()) if as_json else page)


@click.command()
@_class_folder
@click.argument("assignment", required=False, default="")
@click.option(
    "--output", type=click.Path(path_type=Path), help="The page to write. The default is FOLDER/similar.html."
)
def similar(folder: Path, assignment: str, output: Path | None) -> None:
    """Find pairs of submissions in the class FOLDER that are closer than the task explains.

    A pair is a hint, not a proof. If ASSIGNMENT is named, only that one is compared.

    Exit code 0: everything was compared; 2: the lines say what was not, and why.
    """
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.errors import clear_disk_errors
    from autograder.grading.similarity.close_pairs import find_similar
    from autograder.grading.similarity.similarity_page import write_page
    from autograder.grading.similarity.similarity_text import show

    with grading_errors():
        directory = ClassDirectory(folder)
        with clear_disk_errors(directory.path):
            found = find_similar(directory, assignment)
            page = write_page(found, output)
    show(found, page)
    sys.exit(found.exit_code)


@click.command()
@_class_folder
@click.argument("before", required=False, default="")
@click.argument("after", required=False, default="")
def compare(folder: Path, before: str, after: str) -> None:
    """Show whose points the last run of the class FOLDER has changed.

    BEFORE and AFTER are runs, by the times in the first line that this prints.
    """
    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.table import point_differences

    with grading_errors(), ClassStore(ClassDirectory(folder)) as store:
        old, new, found = point_differences.compare(store, before, after)
    click.echo(f"{old} → {new}: {counted(len(found), 'difference')}")
    for difference in found:
        click.echo(printable(difference.line()))


@click.command()
@click.argument("scheduler", required=False, metavar="[tcp://HOST:PORT]")
@click.option(
    "--jobs", type=click.IntRange(min=1), help="Submissions at once. The default is the number of cores."
)
@click.option("--name", help="The name of this worker in messages. The default is host and process.")
@click.option(
    "--unsafe-no-sandbox",
    is_flag=True,
    help="Work even if no sandbox is possible. Submissions then run with all your rights.",
)
def worker(scheduler: str | None, jobs: int | None, name: str | None, unsafe_no_sandbox: bool) -> None:
    """Work for `grade --scheduler`, until Ctrl-C or until the scheduler ends."""
    from autograder.grading.cluster import connection

    with grading_errors():
        connection.check_dask()
        from autograder.grading.cluster.start_worker import start_worker

        start_worker(scheduler, jobs=jobs, name=name, sandbox=not unsafe_no_sandbox, tell=click.echo)


@click.command()
@click.argument("folder", type=click.Path(path_type=Path), default=Path("demo-class"))
def demo(folder: Path) -> None:
    """Make a sample class, grade it and show the result."""
    from autograder.grading.classes import sample_class

    with grading_errors():
        report = sample_class.demo(folder)
    sys.exit(report.exit_code)


COMMANDS = (
    hand_out,
    new_class,
    renew_class,
    collect,
    grade,
    export,
    report,
    similar,
    compare,
    worker,
    demo,
)
