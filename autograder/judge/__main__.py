"""``python -m autograder.judge --socket PATH [--controlled]``: the judge of one notebook."""

from __future__ import annotations

import argparse
from pathlib import Path


def main() -> None:
    """Prepare ROS, then serve until stdin ends."""
    parser = argparse.ArgumentParser(prog="python -m autograder.judge", description=__doc__)
    parser.add_argument("--socket", type=Path, required=True, help="where notebooks reach the judge")
    parser.add_argument(
        "--controlled", action="store_true", help="answer only the checks that are opened on standard input"
    )
    arguments = parser.parse_args()
    from autograder.judge import settings

    settings.prepare_judge()
    from autograder.judge import server, warm

    warm.imports()
    server.run(arguments.socket, controlled=arguments.controlled)


if __name__ == "__main__":
    main()
