"""A name that ``nbgrader_config.py`` still has in classes made before November 2026."""

from __future__ import annotations

from typing import Any


def before_autograde(**_: Any) -> None:
    """Do nothing: the engine takes grades back itself, before it executes anything."""
