"""The fork servers of this process: started at the first need, kept until it ends.

A batch starts them once, and so does plain ``nbgrader autograde``, which executes one notebook after the other. They
end with this process, in whatever way it ends.
"""

from __future__ import annotations

import atexit
import threading
from typing import TYPE_CHECKING

from autograder import course
from autograder.boxes.fork_server import ForkServers
from autograder.judge.settings import boxed_ros_environment, ros_environment

if TYPE_CHECKING:
    from autograder.boxes.fork_server import Addresses

_JUDGE_MODULE = "autograder.judge.serving.attached"
_kept: dict[bool, ForkServers] = {}
_changing = threading.Lock()


def addresses(sandbox: bool) -> Addresses:
    """The addresses of the fork servers, which are started where they do not run.

    Args:
        sandbox: With one for the supervisors of boxes.
    """
    with _changing:
        kept = _kept.get(sandbox)
        if kept is None or not kept.alive:
            if kept is not None:
                kept.stop()
            variables = boxed_ros_environment() if sandbox else ros_environment()
            kept = _kept[sandbox] = ForkServers(
                _JUDGE_MODULE,
                boxed=sandbox,
                environment=variables,
                of_judges=course.variables(),
                interfaces=course.interface_modules(),
            )
        return kept.addresses


def holds(sandbox: bool) -> bool:
    """True if all of them run that were started."""
    with _changing:
        kept = _kept.get(sandbox)
        return kept is not None and kept.alive


@atexit.register
def stop() -> None:
    """End them all with what came from them."""
    with _changing:
        for kept in _kept.values():
            kept.stop()
        _kept.clear()
