"""The exercises: one module each. Importing this package costs nothing; a module is imported when it is asked for."""

from __future__ import annotations

import difflib
import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.exercises.model import Exercise

_MODULES = {
    "lab_1_1.hello": "lab_1_1_hello",
    "lab_1_2.talker": "lab_1_2_talker",
    "lab_1_2.listener": "lab_1_2_listener",
    "inspecting_topics.mismatch": "inspecting_topics_mismatch",
    "lab_1_3.interface": "lab_1_3_interface",
    "lab_1_3.server": "lab_1_3_server",
    "lab_1_3.client": "lab_1_3_client",
    "inspecting_services.question": "inspecting_services_question",
    "lab_1_4.server": "lab_1_4_server",
    "lab_1_4.client": "lab_1_4_client",
    "exercise_1_1.remap": "exercise_1_1_remap",
    "exercise_1_2.three_ints": "exercise_1_2_three_ints",
    "exercise_1_3.cancel": "exercise_1_3_cancel",
}


class UnknownExercise(LookupError):
    """There is no exercise of that id. The message names the nearest ones."""


def all_ids() -> tuple[str, ...]:
    """The ids of all exercises, in the order of the course."""
    return tuple(_MODULES)


def get(exercise_id: str) -> Exercise:
    """The exercise of that id.

    Raises:
        UnknownExercise: There is none.
    """
    if exercise_id not in _MODULES:
        near = difflib.get_close_matches(exercise_id, _MODULES, n=3, cutoff=0.4) or list(_MODULES)
        raise UnknownExercise(f"no exercise is called {exercise_id!r}; did you mean {' or '.join(near)}?")
    module = importlib.import_module(f"autograder.exercises.{_MODULES[exercise_id]}")
    exercise: Exercise = module.EXERCISE
    return exercise


def grade_id(exercise_id: str) -> str:
    """The nbgrader grade_id of an exercise's check cell: nbgrader allows no dot in it."""
    return exercise_id.replace(".", "-")
