"""The arguments and options that several commands about a class have."""

from __future__ import annotations

import functools
from pathlib import Path
from zoneinfo import ZoneInfo

import click

from autograder.cli.command_results import fail

CONFIG_NAME = "nbgrader_config.py"


class _ClassCommand(click.Command):
    """A command about a class, whose first argument is the folder of the class: by default the current folder."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Insert the current folder, if it is a class and the first argument is not one."""
        first = next((word for word in args if not word.startswith("-")), "")
        is_here = Path(CONFIG_NAME).is_file() and not (Path(first or ".nothing") / CONFIG_NAME).is_file()
        return super().parse_args(ctx, [".", *args] if is_here and "--help" not in args else args)


class_command = functools.partial(click.command, cls=_ClassCommand)
class_folder = click.argument("folder", type=click.Path(path_type=Path))
only_assignments = click.option(
    "--assignment", "assignments", multiple=True, help="Use only this assignment; may be given several times."
)
only_sections = click.option(
    "--section",
    "sections",
    multiple=True,
    help="Use only students with this value in the column section of students.csv.",
)
one_assignment = click.option(
    "--assignment",
    default="",
    help="The assignment to which all files belong. The default is the one that cells and file names show.",
)
from_option = click.option(
    "--from",
    "form",
    type=click.Choice(["moodle", "canvas", "blackboard", "brightspace", "gradescope", "sakai", "ilias"]),
    callback=lambda _context, _option, chosen: chosen or "",
    help="The system from which the files come, if file names do not show it. Needed for ILIAS.",
)
student_option = click.option(
    "--student",
    default="",
    metavar="ID",
    help="The student to whom all files belong. The default is the one whom each name identifies.",
)
names_option = click.option(
    "--names",
    default="",
    metavar="'{id}-{last}_{assignment}'",
    help="The pattern of file names, with id, email, login, number, name, first, last, assignment, time, file, any, or "
    "a column of students.csv.",
)


def known_zone(_context: click.Context, _option: click.Parameter, name: str) -> ZoneInfo | None:
    """Return the time zone with this name; None if the option was not given."""
    try:
        return ZoneInfo(name) if name else None
    except (ValueError, OSError, LookupError):
        fail(f"The time zone {name!r} does not exist. A name looks like Europe/Berlin.")


def _pairs(_context: click.Context, option: click.Parameter, values: tuple[str, ...]) -> dict[str, str]:
    """Return the pairs of an option that were written as ``OLD=NEW``."""
    found = {old.strip(): new.strip() for old, _, new in (one.partition("=") for one in values)}
    if not all((*found, *found.values())):
        fail(f'{option.opts[0]} needs two names with = between them: {option.opts[0]} "{option.metavar}"')
    return found


into_columns = click.option(
    "--column",
    "columns",
    multiple=True,
    callback=_pairs,
    metavar="ASSIGNMENT=COLUMN",
    help="The column for an assignment in the list, if its name does not show it; may be given several times.",
)
rename_option = click.option(
    "--rename",
    "said",
    multiple=True,
    callback=_pairs,
    metavar="OLD=NEW",
    help="A student's old and new id, if no number in the list shows that both are one student; may be given several "
    "times.",
)
over_option = click.option(
    "--over", is_flag=True, help="Replace points that a person typed into the LMS. By default, they stay."
)
jobs_option = click.option(
    "--jobs",
    type=click.IntRange(min=1),
    help="The number of notebooks to run at the same time. The default is as many as processors and memory allow.",
)
