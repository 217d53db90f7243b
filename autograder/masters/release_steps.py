"""Gives a class's configuration the steps of a release, and loads them only when nbgrader makes a release."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from traitlets.config.loader import DeferredConfig

if TYPE_CHECKING:
    from nbgrader.preprocessors import NbGraderPreprocessor


class ReleaseSteps(DeferredConfig):
    """The value of ``c.GenerateAssignment.preprocessors`` in the configuration of a class.

    The steps are imported (:func:`autograder.masters.notebook_release.release_preprocessors`) only when nbgrader makes
    a release, because importing takes a second, and other commands, such as ``grade``, also read the configuration.
    """

    def get_value(self, trait: Any) -> list[type[NbGraderPreprocessor]]:  # noqa: ARG002  (traitlets' signature)
        """Return the steps. ``traitlets`` calls this (``traitlets/config/configurable.py``: ``_load_config``)."""
        from autograder.masters.notebook_release import release_preprocessors

        return release_preprocessors()
