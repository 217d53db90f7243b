"""``python -m autograder`` and the ``autograder`` command."""

from __future__ import annotations

import os
import sys


def main() -> None:
    """Run the command line; a closed pipe and Ctrl-C end it quietly."""
    from autograder.cli import cli

    try:
        cli()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)


if __name__ == "__main__":
    main()
