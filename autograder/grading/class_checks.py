"""Checks a class before it is graded: its nbgrader configuration, and whether the course's masters have changed.

This grader replaces nbgrader's grading, and supports only some of nbgrader's options. If a class sets another option,
no command grades the class, because the option would be ignored without notice.

A class has its own copy of each notebook, in ``source``. But the judge uses the exercises of the current course, so it
may expect something that the copy does not ask for. Only changes of graded cells and answer cells are found.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from autograder import course
from autograder.boxes.run_limits import Limits
from autograder.command_name import COMMAND
from autograder.grading.class_records import Origin
from autograder.grading.classes.class_directory import CONFIG_NAME
from autograder.grading.grading_errors import GradingError, course_command
from autograder.masters.master_files import MasterError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from nbformat import NotebookNode
    from traitlets.config import Config

    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory


class _Options(msgspec.Struct):
    """The options of nbgrader that this grader supports; ``supported_options.toml`` describes the attributes."""

    limits: tuple[str, ...]
    any_value: dict[str, tuple[str, ...]]
    one_value: dict[str, dict[str, Any]]
    no_effect: tuple[str, ...]
    use_instead: dict[str, str]


_OPTIONS = msgspec.toml.decode(Path(__file__).with_name("supported_options.toml").read_bytes(), type=_Options)


def check_configuration(directory: ClassDirectory) -> None:
    """Check that a class's configuration sets only supported options.

    Raises:
        GradingError: An option, which the message names, is not supported.
    """
    path = directory.path / CONFIG_NAME
    for option in _unsupported_options(directory.config):
        instead = f" {_OPTIONS.use_instead[option]}." if option in _OPTIONS.use_instead else ""
        raise GradingError(
            f"{path} sets c.{option}, but this grader does not support that value: delete the line, or "
            f"write it as in a class that `{COMMAND} new-class` makes.{instead}"
        )
    for section in ("Autograde", "GenerateFeedback"):
        if not directory.config[section].get("exporter_class"):
            raise GradingError(
                f"{path} does not set c.{section}.exporter_class. Without it, nbgrader's own commands "
                f"bypass the judge. Copy the line from a class that `{COMMAND} new-class` makes."
            )
    limits_of(directory)
    _ = directory.overlays  # raises an error if it names something else


def limits_of(directory: ClassDirectory) -> Limits:
    """Return the limits for a class's submissions, from its configuration or the defaults.

    Raises:
        GradingError: A limit is not a number greater than zero.
    """
    configured = directory.config.WireExecute
    limits: dict[str, Any] = {}
    for name in configured.keys() & set(_OPTIONS.limits):
        with contextlib.suppress(TypeError, ValueError, OverflowError):
            limits[name] = type(getattr(Limits(), name))(configured[name])
        if not 0 < limits.get(name, 0) < math.inf:
            raise GradingError(
                f"{directory.path / CONFIG_NAME} sets c.WireExecute.{name} to {configured[name]!r}: write a "
                f"number above zero, such as {getattr(Limits(), name)}."
            )
    return Limits(**limits)


def _unsupported_options(config: Config) -> Iterator[str]:
    for section in sorted({*_OPTIONS.any_value, *_OPTIONS.one_value, *_OPTIONS.no_effect}):
        allowed, only = _OPTIONS.any_value.get(section, ()), _OPTIONS.one_value.get(section, {})
        for option, value in config[section].items():
            if option not in allowed and (option not in only or value != only[option]):
                yield f"{section}.{option}"


def note_origins(store: ClassStore, made: Mapping[str, tuple[Path, NotebookNode]]) -> None:
    """Record from which masters new source notebooks were made.

    Args:
        made: For each assignment, the path of its master and the new source notebook.
    """
    store.note_origins(
        {
            name: Origin(
                _path_in_course(master), _digest([master.read_text("utf-8")]), _graded_work_digest(notebook)
            )
            for name, (master, notebook) in made.items()
        }
    )


def changed_master_warnings(
    directory: ClassDirectory, store: ClassStore, assignments: Iterable[str]
) -> list[str]:
    """Return a warning for each assignment whose master has changed since the class got its source notebook.

    If the class has no record of its masters, return one warning about that.

    Args:
        store: The class's store. It records for each source notebook its master, as the master was then.
        assignments: The assignments to be graded.
    """
    # The masters may have changed since the class's notebooks were made, so use what the class recorded at that time.
    origins = store.origins()
    if not origins:
        return [
            "This class was made by an older version, so it is unknown whether the course's tasks have changed "
            "since. The judge expects what the tasks in the course ask for now. Compare a notebook in source with "
            "the course; or update the class's notebooks, and hand out the new ones: "
            + course_command("renew-class", directory.path)
        ]
    return [
        _changed_master_warning(directory, name)
        for name in assignments
        if name in origins and _has_changed(origins[name])
    ]


def _changed_master_warning(directory: ClassDirectory, assignment: str) -> str:
    """Return the warning that the master of an assignment has changed."""
    return (
        f"{assignment}: the course's tasks have changed since this class got its notebook. The judge expects what the "
        "tasks ask for now, so answers to the old tasks may fail. To see whose points would change: "
        f"{course_command('grade', directory.path, '--dry-run')}. To hand out and grade the new tasks: "
        f"{course_command('renew-class', directory.path, '--assignment', assignment)}. "
        "To grade answers to the old tasks, use the version of the course that you handed out."
    )


def _has_changed(origin: Origin) -> bool:
    master = course.root() / origin.master
    try:
        if _digest([master.read_text("utf-8")]) == origin.text:
            return False
        # Imported here because this import takes a second and is rarely needed.
        from autograder.masters.source_notebooks import source_notebook

        return _graded_work_digest(source_notebook(master)) != origin.work
    except (OSError, UnicodeDecodeError, MasterError):
        return False  # the master cannot be read, for example while an author edits it


def _path_in_course(master: Path) -> str:
    """Return the path of a master relative to the course, so that the course may be moved; or else the full path."""
    path, root = master.resolve(), course.root().resolve()
    return str(path.relative_to(root) if path.is_relative_to(root) else path)


def _graded_work_digest(notebook: NotebookNode) -> str:
    marks = [(cell.metadata.get("nbgrader", {}), cell.source) for cell in notebook.cells]
    return _digest([source for mark, source in marks if mark.get("grade") or mark.get("solution")])


def _digest(parts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()
