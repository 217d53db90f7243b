"""A digest of everything that decides what a judge sees of an answer, and of nothing that decides what it says of it.

It is made of the scenario, the judge's bench and what starts the subject (``tests/measure/driving_code.py``), and of
the reference output, without its texts. Criteria, diagnoses and words change without it, unless the scenario asks for
one of them.
"""

from __future__ import annotations

import functools
import hashlib
import json
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from typing import Any

import autograder
from autograder import exercises, workspaces
from autograder.judge import one_check
from tests.measure.driving_code import DrivingCode

PROFILE = Path(autograder.__file__).parent / "judge" / "fastdds_profile.xml"
STARTS = tuple(
    f"autograder.judge.{name}"
    for name in ("notebook_subject", "path_subject", "command_check", "ros_setup", "machine_fitness")
)
"""The modules that start a subject, whatever its kind is."""


KNOWN: dict[str, str] = {}
"""The digests that this process has made, or was told by the one that started it: all of them take seconds."""


def digest(exercise_id: str) -> str:
    """Return the digest of an exercise, made once; for the errors see :func:`new_digest`."""
    if exercise_id not in KNOWN:
        KNOWN[exercise_id] = new_digest(exercise_id)
    return KNOWN[exercise_id]


def new_digest(exercise_id: str) -> str:
    """Return the SHA-256 of everything that the evidence of an exercise's answers depends on, without the answers.

    Raises:
        UnknownExercise: There is no such exercise.
        BrokenExercise: The exercise cannot be imported.
        OSError: The exercise was never recorded.
    """
    exercise = exercises.get(exercise_id)
    code = DrivingCode()
    for function in (exercise.scenario, exercise.runner, one_check.look):
        code.add(function)
    for name in (*STARTS, *(_builders() if exercise.runner else ())):
        code.add_module(import_module(name))
    recorded = json.loads(exercises.reference_path(exercise_id).read_text(encoding="utf-8"))
    parts = [
        json.dumps(without_texts(recorded), sort_keys=True),
        repr((exercise.second_look, exercise.limit)),
        PROFILE.read_text(encoding="utf-8"),
        *code.texts(),
    ]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


@functools.cache
def _builders() -> tuple[str, ...]:
    """Return the modules that build and run the subject of an exercise that has a runner."""
    found = walk_packages(workspaces.__path__, f"{workspaces.__name__}.")
    return tuple(sorted(module.name for module in found))


def without_texts(reference: dict[str, Any]) -> dict[str, Any]:
    """Return a reference output without recorded wrong answers, and without the words for what was given."""
    kept = {key: value for key, value in reference.items() if key != "variants"}
    for part in kept["parts"]:
        for event in part["events"]:
            event.get("data", {}).pop("given", None)
    return kept
