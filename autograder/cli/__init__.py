"""The ``autograder`` command. Each of its commands calls the part of the package that does the work.

Exit codes: 0 for success; 1 if the answer is no (a failed check, notebooks out of date); 2 if the command could not
be done (bad input, or an error of the grader). Imports are inside the commands, so that ``check`` starts fast.
"""

from __future__ import annotations

from pathlib import Path

import click

from autograder import course
from autograder.cli import appeals, authors, instructors, reports, students

GROUPS = {
    "Students": students.COMMANDS,
    "Instructors, a class": instructors.COMMANDS,
    "Instructors, its results": (*reports.COMMANDS, *appeals.COMMANDS),
    "Authors": authors.COMMANDS,
}
"""The commands grouped by the people who type them, in the order in which the help lists them."""
_HERE = (instructors.new_class, instructors.hand_out, students.lab, students.progress, students.reset)
IN_A_COURSE = {str(command.name) for command in (*_HERE, *authors.COMMANDS)}
"""The commands that work on the course around the current folder, in addition to `check` for one's own program. Every
other command is for a class and uses the course that `new-class` recorded, because students' work could contain a
course of their own.
"""


class _Groups(click.Group):
    """A command whose help lists its subcommands grouped by the people who type them."""

    def format_commands(self, _ctx: click.Context, formatter: click.HelpFormatter) -> None:
        for title, commands in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl(
                    [
                        (str(command.name), (command.help or "").split("\n\n")[0].replace("\n", " "))
                        for command in commands
                    ]
                )


@click.group(cls=_Groups, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="ros2-course-autograder", prog_name="autograder")
@click.pass_context
def cli(context: click.Context) -> None:
    """Check ROS 2 exercises on the wire, build the notebooks, grade a class."""
    if context.invoked_subcommand in IN_A_COURSE:
        course.use_the_one_around(Path.cwd())


for group in GROUPS.values():
    for command in group:
        cli.add_command(command)
