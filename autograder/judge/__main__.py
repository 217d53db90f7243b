"""``python -m autograder.judge --socket PATH``: run the judge for one notebook.

``--attached LISTENER ORDERS`` instead runs a judge that a grader controls: it runs only the checks that the grader
orders. LISTENER and ORDERS are file descriptors of inherited sockets.
"""

from __future__ import annotations

import argparse
from pathlib import Path


def main() -> None:
    """Prepare ROS, then serve until stdin is closed or the grader disconnects."""
    parser = argparse.ArgumentParser(prog="python -m autograder.judge", description=__doc__)
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--socket", type=Path, help="the Unix socket at which notebooks reach the judge")
    where.add_argument(
        "--attached", type=int, nargs=2, metavar=("LISTENER", "ORDERS"), help="descriptors of two sockets"
    )
    arguments = parser.parse_args()
    from autograder.judge import controlled_judge

    controlled_judge.prepare()
    if arguments.attached:
        controlled_judge.run({}, arguments.attached)
        return
    from autograder.judge import check_server

    check_server.run(arguments.socket)


if __name__ == "__main__":
    main()
