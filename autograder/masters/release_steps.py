"""The steps of a release for a class's configuration, which is read by every command and seldom needs them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from traitlets.config.loader import DeferredConfig

if TYPE_CHECKING:
    from nbgrader.preprocessors import NbGraderPreprocessor


class ReleaseSteps(DeferredConfig):
    """The value of ``c.GenerateAssignment.preprocessors`` in a class.

    The steps themselves come from :func:`autograder.masters.release.release_preprocessors` once nbgrader makes a
    release: to import them takes a second, which a command such as ``grade`` would spend for nothing.
    """

    def get_value(self, trait: Any) -> list[type[NbGraderPreprocessor]]:  # noqa: ARG002  (traitlets' signature)
        """The steps; ``traitlets`` asks for them (``traitlets/config/configurable.py``: ``_load_config``)."""
        from autograder.masters.release import release_preprocessors

        return release_preprocessors()
