"""Checks that ``nbgrader_config.py`` sets no option of grading to a value that this grader does not support.

This grader replaces nbgrader's grading, and supports only some of nbgrader's options. If a class sets another option,
no command grades the class, because the option would be ignored without notice.
"""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, Any

from autograder.boxes.limits import Limits
from autograder.grading.classes.class_directory import CONFIG_NAME
from autograder.grading.errors import ClassIncomplete
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from traitlets.config import Config

    from autograder.grading.classes.class_directory import ClassDirectory

_EXPORTER = "autograder.grading.nbgrader_commands.SubmissionExporter"
_STEP = "autograder.grading.nbgrader_commands.WireExecute"
_ANYTHING = object()
_LIMITS: Mapping[str, type[float | int]] = {
    "cell_seconds": float,
    "notebook_seconds": float,
    "cpu_seconds": float,
    "memory_bytes": int,
    "processes": int,
    "scratch_bytes": int,
}
_MAY_BE: Mapping[str, Mapping[str, tuple[Any, ...]]] = {
    "Autograde": {
        "exporter_class": (_EXPORTER,),
        "autograde_preprocessors": ([_STEP],),
    },
    "GenerateFeedback": {"exporter_class": ("autograder.grading.nbgrader_commands.FeedbackExporter",)},
    "HTMLExporter": {
        "filters": ({"markdown2html": "autograder.grading.returning.page_exporter.markdown_to_html"},)
    },
    # nbgrader's exchange uses include, max_file_size and max_dir_size.
    "CourseDirectory": dict.fromkeys(
        ("root", "db_url", "course_id", "include", "max_file_size", "max_dir_size"), (_ANYTHING,)
    ),
    "WireExecute": dict.fromkeys((*_LIMITS, "unsafe_no_sandbox", "demonstrations"), (_ANYTHING,)),
    # The options of these sections belong to nbgrader's own grading, and would have no effect.
    **{
        section: {}
        for section in (
            "BaseConverter",
            "NbConvertBase",
            "NbGraderPreprocessor",
            "Exporter",
            "NotebookExporter",
            "TemplateExporter",
            "SubmissionExporter",
            "FeedbackExporter",
            "SaveAutoGrades",
            "GetGrades",
            "CSSHTMLHeaderPreprocessor",
            "FilesWriter",
            "WriterBase",
            "Execute",
            "ExecutePreprocessor",
            "NotebookClient",
            "IgnorePattern",
        )
    },
}
"""The supported options by section, with their supported values. In sections that are not listed, any option is
allowed.
"""


_INSTEAD = {
    f"{section}.timeout": "c.WireExecute.cell_seconds limits the time of a cell"
    for section in ("Execute", "ExecutePreprocessor", "NotebookClient")
}
"""For an unsupported option, a sentence about the option to use instead."""


def check_configuration(directory: ClassDirectory) -> None:
    """Check that a class's configuration sets only supported options.

    Raises:
        ClassIncomplete: An option, which the message names, is not supported.
    """
    path = directory.path / CONFIG_NAME
    for option in _not_honoured(directory.config):
        instead = f" {_INSTEAD[option]}." if option in _INSTEAD else ""
        raise ClassIncomplete(
            f"{path} sets c.{option}, but this grader does not support that value: delete the line, or "
            f"write it as in a class that `{COMMAND} new-class` makes.{instead}"
        )
    for section in ("Autograde", "GenerateFeedback"):
        if not directory.config[section].get("exporter_class"):
            raise ClassIncomplete(
                f"{path} does not set c.{section}.exporter_class. Without it, nbgrader's own commands "
                f"bypass the judge. Copy the line from a class that `{COMMAND} new-class` makes."
            )
    limits_of(directory)


def limits_of(directory: ClassDirectory) -> Limits:
    """Return the limits for a class's submissions, from its configuration or the defaults.

    Raises:
        ClassIncomplete: A limit is not a number greater than zero.
    """
    configured = directory.config.WireExecute
    found: dict[str, Any] = {}
    for name in _LIMITS.keys() & configured.keys():
        with contextlib.suppress(TypeError, ValueError, OverflowError):
            found[name] = _LIMITS[name](configured[name])
        if not 0 < found.get(name, 0) < math.inf:
            raise ClassIncomplete(
                f"{directory.path / CONFIG_NAME} sets c.WireExecute.{name} to {configured[name]!r}: write a "
                f"number above zero, such as {getattr(Limits(), name)}."
            )
    return Limits(**found)


def _not_honoured(config: Config) -> Iterator[str]:
    for section, options in _MAY_BE.items():
        for option, value in config[section].items():
            allowed = options.get(option, ())
            if _ANYTHING not in allowed and value not in allowed:
                yield f"{section}.{option}"
