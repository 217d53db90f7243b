"""A judge on descriptors that it was given: what a fork of a fork server becomes in the judge's box."""

from __future__ import annotations

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
    """Import ROS, the judge, every exercise and the interfaces. Makes no node and no thread."""
    settings.prepare_judge()
    importlib.import_module("autograder.judge.serving.server")
    importlib.import_module("autograder.judge.serving.preimport").imports()


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
    profile = str(settings.PROFILE)
    return {
        **course.variables(),
        **(settings.boxed_ros_environment() if boxed else settings.ros_environment()),
        "FASTDDS_DEFAULT_PROFILES_FILE": profile,
        "FASTRTPS_DEFAULT_PROFILES_FILE": profile,
    }


def readable() -> list[Path]:
    """The files that a judge must be able to read beside the package: the reference outputs alone."""
    files = [exercises.reference_path(exercise_id) for exercise_id in exercises.all_ids()]
    return [file for file in files if file.is_file()]
