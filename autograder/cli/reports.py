"""The commands for instructors about graded work: report, export to the LMS, similar answers, changed points."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from autograder.cards.readable import printable
from autograder.cli.instructors import class_folder, only_assignments, only_sections
from autograder.cli.results import as_json_option, fail, grading_errors, print_json
from autograder.kit.in_words import counted


@click.command()
@class_folder
@click.option(
    "--to",
    type=click.Choice(["canvas", "moodle", "blackboard", "brightspace", "sakai", "ilias", "csv", "xlsx"]),
    required=True,
    help="The LMS that will import the files.",
)
@only_assignments
@only_sections
@click.option(
    "--into",
    type=click.Path(path_type=Path),
    help="Fill in this list, which was exported from the LMS given by --to.",
)
@click.option(
    "--column",
    "columns",
    multiple=True,
    metavar="ASSIGNMENT=COLUMN",
    help="The column for an assignment in the list given by --into; may be given several times.",
)
@click.option(
    "--absent",
    type=click.Choice(["blank", "zero"]),
    default="blank",
    help="The value for students without a submission. The default is an empty cell.",
)
@click.option(
    "--output",
    type=click.Path(path_type=Path),
    help="The folder to write the files to. The default is FOLDER/export.",
)
@as_json_option
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
        fail('--column needs an assignment and the name of its column: --column "ASSIGNMENT=COLUMN"')
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
        files = [{"path": str(file), "purpose": purpose} for file, purpose in done.files]
        print_json({"files": files, "notices": done.notices})
        return
    for file, purpose in done.files:
        click.echo(f"{printable(str(file))}\n    {printable(purpose)}")
    for notice in done.notices:
        click.echo(f"note: {printable(notice)}")


@click.command()
@class_folder
@only_sections
@click.option(
    "--without-names",
    is_flag=True,
    help="Show numbers instead of students' names, and no links to their pages.",
)
@click.option(
    "--output", type=click.Path(path_type=Path), help="The page to write. The default is FOLDER/report.html."
)
@as_json_option
def report(
    folder: Path, sections: tuple[str, ...], without_names: bool, output: Path | None, as_json: bool
) -> None:
    """Write a page about the class FOLDER: points, mistakes, exercises and each student's progress."""
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.report_page.page import write_report
    from autograder.grading.reporting.report import table_json
    from autograder.grading.table.class_table import read_table

    if as_json and without_names:
        fail(
            "--json shows the ids of students, so it cannot be combined with --without-names: leave out one of the two."
        )
    with grading_errors():
        page = write_report(folder, names=not without_names, to=output, sections=sections)
        if as_json:
            print_json(table_json(page, read_table(ClassDirectory(folder), sections)))
        else:
            click.echo(page)


@click.command()
@class_folder
@click.argument("assignment", required=False, default="")
@click.option(
    "--output", type=click.Path(path_type=Path), help="The page to write. The default is FOLDER/similar.html."
)
@as_json_option
def similar(folder: Path, assignment: str, output: Path | None, as_json: bool) -> None:
    """Find pairs of submissions in the class FOLDER with more similar code than their task explains.

    A pair is a hint, not a proof. If ASSIGNMENT is given, only its submissions are compared.

    Exit code 0: all submissions were compared; 2: some were not, and the printed lines say which and why.
    """
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.errors import clear_disk_errors
    from autograder.grading.similarity.close_pairs import find_similar
    from autograder.grading.similarity.similarity_page import write_page
    from autograder.grading.similarity.similarity_text import show, similar_json

    with grading_errors():
        directory = ClassDirectory(folder)
        with clear_disk_errors(directory.path):
            found = find_similar(directory, assignment)
            page = write_page(found, output)
    if as_json:
        print_json(similar_json(found, page))
    else:
        show(found, page)
    sys.exit(found.exit_code)


@click.command()
@class_folder
@click.argument("before", required=False, default="")
@click.argument("after", required=False, default="")
@as_json_option
def compare(folder: Path, before: str, after: str, as_json: bool) -> None:
    """Show whose points the last run of `grade` in the class FOLDER has changed.

    BEFORE and AFTER select two other runs by their times, written as in the first line that this command prints.
    """
    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.table import point_differences

    with grading_errors(), ClassStore(ClassDirectory(folder)) as store:
        old, new, found = point_differences.compare(store, before, after)
    if as_json:
        print_json({"before": old, "after": new, "differences": found})
        return
    click.echo(f"{old} → {new}: {counted(len(found), 'difference')}")
    for difference in found:
        click.echo(printable(difference.line()))


COMMANDS = (
    report,
    export,
    similar,
    compare,
)
