"""The exporter that a class's ``nbgrader_config.py`` names for grading: through it, nbgrader comes to the engine."""

from __future__ import annotations

from typing import Any

from nbconvert.exporters import NotebookExporter

from autograder.grading.nbgrader_commands import take_over


class SubmissionExporter(NotebookExporter):
    """By this name nbgrader finds our way of grading, whoever starts ``autograde``."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        take_over(self.parent)
