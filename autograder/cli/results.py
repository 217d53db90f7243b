"""Prints the result of a command as JSON, and ends a command that fails with a clear line."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, NoReturn

import click

if TYPE_CHECKING:
    from collections.abc import Iterator

NO = 1
CANNOT = 2
INTERRUPTED = 130
"""The exit code that a shell reports for a program that Ctrl-C ended: 128 plus the signal's number."""
as_json_option = click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object.")


def print_json(value: Any) -> None:
    """Print a value, or JSON in bytes, as one line of JSON without characters that affect a terminal."""
    import msgspec

    from autograder.cards.readable import printable_json

    data = value if isinstance(value, bytes) else msgspec.json.encode(value, enc_hook=str)
    click.echo(printable_json(data.decode()))


def fail(message: str) -> NoReturn:
    """End the command with a clear error message and exit code 2."""
    click.echo(f"autograder: {message}", err=True)
    sys.exit(CANNOT)


def need_ros() -> None:
    """Stop a command before it starts a judge, whose process would only fail.

    Raises:
        ModuleNotFoundError: ROS cannot be imported. ``autograder/__main__.py`` then says what to type.
    """
    if find_spec("rclpy") is None:
        raise ModuleNotFoundError("No module named 'rclpy'", name="rclpy")


@contextmanager
def grading_errors() -> Iterator[None]:
    """Turn the grader's own errors in the block into a clear line and exit code 2."""
    from autograder.grading.errors import GradingError

    try:
        yield
    except GradingError as error:
        fail(str(error))
