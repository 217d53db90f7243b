"""Prints the result of a command as JSON. Ends a command that fails with one line about the error."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, NoReturn

import click

from autograder.standard_output import printable, printable_json

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager


NO = 1
CANNOT = 2
INTERRUPTED = 130
"""The exit code after Ctrl-C, as in a shell: 128 plus the number of the signal SIGINT."""
as_json_option = click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object.")


def print_json(value: Any) -> None:
    """Print a value as one line of JSON, without characters that control a terminal. Bytes are taken to be JSON."""
    import msgspec

    data = value if isinstance(value, bytes) else msgspec.json.encode(value, enc_hook=str)
    click.echo(printable_json(data.decode()))


def print_line(text: str, *, err: bool = False) -> None:
    """Print a text that may contain a student's words as one line."""
    click.echo(printable(text), err=err)


def fail(message: str) -> NoReturn:
    """Print an error message and end the command with exit code 2."""
    print_line(f"autograder: {message}", err=True)
    sys.exit(CANNOT)


def need_ros() -> None:
    """End a command with an error if ROS is missing, before the command starts a judge.

    Raises:
        ModuleNotFoundError: ROS cannot be imported. ``autograder/__main__.py`` then says what to type.
    """
    if find_spec("rclpy") is None:
        raise ModuleNotFoundError("No module named 'rclpy'", name="rclpy")


def use_own_interfaces() -> None:
    """Start this command again with the course's interface packages, if this Python cannot import them.

    It takes a new process, because the search path of libraries is read at its start.
    """
    from autograder import course
    from course_runtime.own_interfaces import CannotBuildInterfaces, built_interfaces

    try:
        with failing_with(CannotBuildInterfaces):
            prefixes = built_interfaces(course.root())
    except course.NoCourse:
        return
    if prefixes:
        from autograder.workspaces.builds.install_folder import with_prefixes
        from course_runtime.python_child import INTERPRETER

        environment = with_prefixes(os.environ, prefixes)
        if environment != os.environ:  # else the new process would not find them, either
            os.execve(INTERPRETER, [INTERPRETER, *sys.orig_argv[1:]], environment)


@contextmanager
def failing_with(*errors: type[Exception]) -> Iterator[None]:
    """If the block raises one of these errors, print its message and end the command with exit code 2."""
    try:
        yield
    except errors as error:
        fail(str(error))


def grading_errors() -> AbstractContextManager[None]:
    """If the block raises a ``GradingError``, print its message and end the command with exit code 2."""
    from autograder.grading.grading_errors import GradingError

    return failing_with(GradingError)
