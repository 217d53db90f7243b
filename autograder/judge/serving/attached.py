"""A judge on descriptors that it was given: what a fork of a fork server becomes in the judge's box."""

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
    """Make this process a judge's, with all imports made."""
    settings.prepare_judge()
    importlib.import_module("autograder.judge.serving.server")
    imports()


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Serve one notebook until the grader hangs up.

    Args:
        call: Nothing is told.
        descriptors: The listening socket for the notebook, and the grader's end of the orders.
    """
    from autograder.judge.serving.server import JudgeServer

    del call
    os.environ.pop("RMW_IMPLEMENTATION", None)
    sys.stdout = sys.stderr
    listener, control = (socket.socket(fileno=descriptor) for descriptor in descriptors)
    with control.makefile("rb") as orders, control.makefile("wb") as answers:
        JudgeServer(listener, controlled=True).serve(orders, answers)


def environment(*, boxed: bool) -> dict[str, str]:
    """The variables that :func:`autograder.judge.settings.prepare_judge` sets, and where the course is.

    They are for a judge that gets a new set.

    The folder of the logs is not among them: it is in the box.
    """
    return {
        **course.variables(),
        **(settings.boxed_ros_environment() if boxed else settings.ros_environment()),
        **settings.OF_THE_JUDGE,
    }


def readable() -> list[Path]:
    """The files that a judge must be able to read beside the package: the reference outputs alone."""
    files = [exercises.reference_path(exercise_id) for exercise_id in exercises.all_ids()]
    return [file for file in files if file.is_file()]


_INTERFACES = (
    "std_msgs.msg",
    "rcl_interfaces.msg",
    "rcl_interfaces.srv",
    "rosgraph_msgs.msg",
    "action_msgs.msg",
    "action_msgs.srv",
    # Every node has a service of it; 5 ms of processor time in each check that had to load it.
    "type_description_interfaces.msg",
    "type_description_interfaces.srv",
)


def imports() -> None:
    """Import the judge, every exercise, the interfaces of the course and their compiled type supports.

    No check pays for them afterwards. Makes no node and no thread.
    """
    for name in ("subjects.command_subject", "subjects.remote_subject", "verdicts.trial"):
        importlib.import_module(f"autograder.judge.{name}")

    # One that is broken, while somebody writes it, keeps nobody from being judged by another one.
    exercises.unbroken()
    for name in (*_INTERFACES, *course.interface_modules()):
        with contextlib.suppress(ImportError):
            module = importlib.import_module(name)
            for kind in vars(module).values():
                load = getattr(type(kind), "__import_type_support__", None)
                if load is not None:
                    load()
