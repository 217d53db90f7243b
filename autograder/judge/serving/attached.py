"""Run a judge on inherited file descriptors, as the fork server in the judge's sandbox does."""

from __future__ import annotations

import contextlib
import importlib
import os
import socket
import sys
from typing import TYPE_CHECKING, Any

from autograder import course, exercises
from autograder.judge import settings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


def prepare() -> None:
    """Set up ROS for a judge in this process and import everything that a check needs."""
    settings.prepare_judge()
    importlib.import_module("autograder.judge.serving.server")
    imports()


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Serve one notebook until the grader disconnects.

    Args:
        call: Empty; the fork server passes this argument to every service.
        descriptors: The listening socket for the notebook, and the socket for the grader's orders.
    """
    from autograder.judge.serving.server import JudgeServer

    del call
    os.environ.pop("RMW_IMPLEMENTATION", None)
    sys.stdout = sys.stderr
    listener, control = (socket.socket(fileno=descriptor) for descriptor in descriptors)
    with control.makefile("rb") as orders, control.makefile("wb") as answers:
        JudgeServer(listener, controlled=True).serve(orders, answers)


def environment(*, boxed: bool) -> dict[str, str]:
    """Return the environment variables of a new judge: ROS settings and the folder of the course.

    :func:`autograder.judge.settings.prepare_judge` sets the same ROS variables in a process that already runs.

    ``ROS_LOG_DIR`` is not among them, because the folder for logs is inside the sandbox.
    """
    return {
        **course.variables(),
        **(settings.boxed_ros_environment() if boxed else settings.ros_environment()),
        **settings.OF_THE_JUDGE,
    }


def readable() -> list[Path]:
    """Return the files outside the package that a judge reads: the reference outputs."""
    files = [exercises.reference_path(exercise_id) for exercise_id in exercises.all_ids()]
    return [file for file in files if file.is_file()]


_INTERFACES = (
    "std_msgs.msg",
    "rcl_interfaces.msg",
    "rcl_interfaces.srv",
    "rosgraph_msgs.msg",
    "action_msgs.msg",
    "action_msgs.srv",
    # Every node offers a service from this package. Loading its type costs 5 ms of processor time, so do it in advance.
    "type_description_interfaces.msg",
    "type_description_interfaces.srv",
)


def imports() -> None:
    """Import the judge, every exercise, the course's interfaces and their compiled type supports.

    A check that is forked later then needs no imports. Forking stays safe, because no node and no thread is created
    here.
    """
    for name in ("subjects.command_subject", "subjects.remote_subject", "verdicts.trial"):
        importlib.import_module(f"autograder.judge.{name}")

    # Skip broken exercises: an unfinished exercise must not prevent checks of other exercises.
    exercises.unbroken()
    for name in (*_INTERFACES, *course.interface_modules()):
        with contextlib.suppress(ImportError):
            module = importlib.import_module(name)
            for kind in vars(module).values():
                load = getattr(type(kind), "__import_type_support__", None)
                if load is not None:
                    load()
