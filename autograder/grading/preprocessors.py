"""The guard that a class's ``nbgrader_config.py`` names in the place of nbgrader's Execute."""

from __future__ import annotations

from typing import Any

from nbgrader.preprocessors import NbGraderPreprocessor


class WireExecute(NbGraderPreprocessor):
    """Refuses to grade. Its section of the configuration has what the engine reads: limits, and two switches."""

    def preprocess(self, *_: Any, **__: Any) -> tuple[Any, Any]:
        """Say what is missing: nbgrader comes here only where the line that leads to the engine was taken out.

        Raises:
            TypeError: Always.
        """
        raise TypeError("Autograde.exporter_class must be autograder.grading.exporter.SubmissionExporter")
