"""``python -m autograder`` and the ``autograder`` command."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from environment.python_child import SAFE_PATH

TERMINATED = 143
"""A shell's exit code for a program that SIGTERM ended: 128 and the signal's number."""


def main() -> None:
    """Run the command line; a closed pipe, Ctrl-C and SIGTERM end it quietly, with all that it has started."""
    # This process has obeyed the variable when it started. A student's program below must not inherit the variable: the
    # program imports modules from its own folder, as Python always does.
    os.environ.pop(SAFE_PATH, None)
    from autograder.cli import cli

    signal.signal(signal.SIGTERM, lambda *_: sys.exit(TERMINATED))
    try:
        cli()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except ImportError as error:
        # What students are handed has no grader in it.
        if (error.name or "").partition(".")[0] != "autograder" or Path(__file__).with_name(
            "grading"
        ).is_dir():
            raise
        print(
            "autograder: this is the students' part of the course: that command is not in it", file=sys.stderr
        )
        sys.exit(2)


if __name__ == "__main__":
    main()
