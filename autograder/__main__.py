"""The entry point of ``python -m autograder`` and of the ``autograder`` command."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from importlib import metadata
from pathlib import Path

import re2

from autograder import course
from autograder.command_name import COMMAND
from course_runtime.installation import PACKAGE, installing
from course_runtime.python_child import SAFE_PATH

TERMINATED = 143
"""The exit code that a shell reports for a program that SIGTERM ended: 128 plus the signal's number."""


def main() -> None:
    """Run the command line. A closed pipe, Ctrl-C or SIGTERM ends the command quietly, with its children."""
    # PYTHONSAFEPATH was needed only at the start of this process. A student's program must not inherit it, because with
    # it, Python would not import modules from the program's own folder.
    os.environ.pop(SAFE_PATH, None)
    from autograder.cli import cli
    from autograder.standard_output import guard_terminal

    guard_terminal()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(TERMINATED))
    try:
        cli(prog_name=COMMAND)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except course.NoCourse as error:
        print(f"autograder: {error}", file=sys.stderr)
        sys.exit(2)
    except ImportError as error:
        missing = _why_missing(error)
        if not missing:
            raise
        print(f"autograder: {missing}", file=sys.stderr)
        sys.exit(2)


def _why_missing(error: ImportError) -> str:
    """Return what to type to get a module that this installation left out; empty for any other module."""
    top = (error.name or "").partition(".")[0]
    if top == "autograder" and not Path(__file__).with_name("grading").is_dir():
        return "this copy of the course is for students and does not contain this command"
    if top == "rclpy":
        return f"ROS 2 was not found: source the setup script of ROS 2 Jazzy, or type: {installing('ros')}"
    with contextlib.suppress(metadata.PackageNotFoundError):
        for line in metadata.requires(PACKAGE) or ():
            name, _, marker = line.partition(";")
            extra = marker.partition("extra == ")[2].strip("\"' ")
            if extra and re2.match(r"[\w.-]+", name)[0].replace("-", "_").lower() == top.lower():
                return f"{top} is not installed, which this command needs: pip install '{PACKAGE}[{extra}]'"
    return ""


if __name__ == "__main__":
    main()
