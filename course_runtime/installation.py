"""Tells how this package was installed, because a wheel has no ``./course`` for its messages to name.

Only the standard library is used: this runs before anything is installed.
"""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = "ros2-on-the-wire"
"""The name of the wheel."""
IS_CLONE = (ROOT / "course").is_file()
"""True in a clone and in a hand-out; False if the wheel is installed."""
COMMAND = "./course" if IS_CLONE else "autograder"
"""The program before each command that a message names."""


def installing(extra: str, clone: str = "") -> str:
    """Return the command that installs what an extra of the package needs.

    Args:
        extra: The name of the extra in pyproject.toml.
        clone: The options of ``./course setup`` in a clone, where only some extras are left out.
    """
    return " ".join(f"./course setup {clone}".split()) if IS_CLONE else f"pip install '{PACKAGE}[{extra}]'"
