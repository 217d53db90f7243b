"""The command line ``autograder``, with its subcommands.

Promises: exit code 0 for success; 1 for a negative result, such as a failed check; 2 if the command could not do its
    work, for example after a wrong option. Each command makes its imports itself, so that ``check`` starts fast.
Names: ``cli``, ``GROUPS``
Imports: ``appeals``, ``authoring``, ``boxes``, ``cards``, ``check_journal``, ``course``, ``dds_discovery``,
    ``exercises``, ``grading``, ``judge``, ``kit``, ``masters``, ``safe_files``,
    ``standard_output``, ``student``, ``verdict``, ``workspaces``.
Takes: the words that a person typed.
Gives: text or JSON on standard output, messages on standard error, and an exit code.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from autograder import course
from autograder.cli import author_commands, class_commands, result_commands, student_commands
from autograder.standard_output import printable

GROUPS = {
    "Students": student_commands.STUDENT_COMMANDS,
    "Instructors, a class": class_commands.CLASS_COMMANDS,
    "Instructors, its results": result_commands.RESULT_COMMANDS,
    "Authors": author_commands.AUTHOR_COMMANDS,
}
"""The commands, grouped by the people who use them, in the order of the help page."""
_HERE = (
    class_commands.new_class,
    class_commands.hand_out,
    student_commands.lab,
    student_commands.progress,
    student_commands.reset,
)
IN_A_COURSE = {str(command.name) for command in (*_HERE, *author_commands.AUTHOR_COMMANDS)}
"""The names of the commands that use the course that contains the current folder. The command `check` uses it as well,
except with --box. Commands for a class never do, because the current folder may contain students' work with a changed
copy of a course. They use the course that `new-class` recorded.
"""


class _Groups(click.Group):
    """A command whose help page groups the subcommands by the people who use them."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a subcommand. An error of click may quote the name of a student's file, which must not begin a line."""
        try:
            return super().invoke(ctx)
        except click.ClickException as error:
            vars(error)["message"] = printable(error.message)
            raise

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
@click.version_option(package_name="ros2-on-the-wire", prog_name="autograder")
@click.pass_context
def cli(context: click.Context) -> None:
    """Check ROS 2 exercises on the wire, build the notebooks, grade a class."""
    if context.invoked_subcommand in IN_A_COURSE:
        course.use_the_one_around(Path.cwd())


for group in GROUPS.values():
    for command in group:
        cli.add_command(command)
