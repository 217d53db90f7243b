"""End a command: with an exit code, and with a clear line if it could not be done."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, NoReturn

import click

if TYPE_CHECKING:
    from collections.abc import Iterator

NO = 1
CANNOT = 2
INTERRUPTED = 130
"""A shell's exit code for a program that Ctrl-C ended: 128 and the signal's number."""


def fail(message: str) -> NoReturn:
    """End with a clear error and exit code 2."""
    click.echo(f"autograder: {message}", err=True)
    sys.exit(CANNOT)


@contextmanager
def grading_errors() -> Iterator[None]:
    """Turn the grader's own errors into a clear line and exit code 2."""
    from autograder.grading.errors import GradingError

    try:
        yield
    except GradingError as error:
        fail(str(error))
