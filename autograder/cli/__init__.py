"""The ``autograder`` command. Thin: each command hands over to the part that does the work.

Exit codes: 0 all is well, 1 the answer is no (a failed check, stale notebooks), 2 it could not be done (bad
input, or trouble of the grader's own). Imports are inside the commands: ``check`` must answer at once.
"""

from __future__ import annotations

import click

from autograder.cli import appeals, authors, instructors, students


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="ros2-course-autograder", prog_name="autograder")
def cli() -> None:
    """Check ROS 2 exercises on the wire, build the notebooks, grade a class."""


for command in (*students.COMMANDS, *authors.COMMANDS, *instructors.COMMANDS, *appeals.COMMANDS):
    cli.add_command(command)
