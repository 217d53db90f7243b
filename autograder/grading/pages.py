"""Names in a class's ``nbgrader_config.py`` for pages: the exporter of feedback, a filter for formgrader."""

from __future__ import annotations

from typing import Any

from autograder.grading.nbgrader_commands import take_over
from autograder.grading.returning.page_exporter import PageExporter, markdown_to_html

__all__ = ["FeedbackExporter", "markdown_to_html"]


class FeedbackExporter(PageExporter):
    """By this name nbgrader finds our way of making pages, whoever starts ``generate_feedback``."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        take_over(self.parent)
