"""What a judge imports before its first check, so that no check pays for it. Makes no node and no thread."""

from __future__ import annotations

import contextlib
import importlib

_INTERFACES = (
    "std_msgs.msg",
    "rcl_interfaces.msg",
    "rosgraph_msgs.msg",
    "my_robot_interfaces.srv",
    "my_robot_interfaces.action",
)


def imports() -> None:
    """Import the judge, every exercise, the interfaces of the course and their compiled type supports."""
    from autograder import exercises

    for name in ("command_subject", "remote_subject", "trial"):
        importlib.import_module(f"autograder.judge.{name}")

    for exercise_id in exercises.all_ids():
        exercises.get(exercise_id)
    for name in _INTERFACES:
        with contextlib.suppress(ImportError):
            module = importlib.import_module(name)
            for kind in vars(module).values():
                load = getattr(type(kind), "__import_type_support__", None)
                if load is not None:
                    load()
