"""Imports that a judge makes before its first check, so that no check pays for them. Makes no node and no thread."""

from __future__ import annotations

import contextlib
import importlib

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
    """Import the judge, every exercise, the interfaces of the course and their compiled type supports."""
    from autograder import course, exercises

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
