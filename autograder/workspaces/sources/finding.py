"""The workspace that a launch file belongs to."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

WORKSPACE = "ros2_ws"
"""The name that workspaces have in the course."""
PACKAGE_VARIABLE = "AUTOGRADER_ROBOT_PACKAGE"
"""Names the folder of the course's own package where a grader has put it within reach of a notebook."""


def workspace_of(file: Path, beside: Iterable[Path]) -> Path | None:
    """The workspace that a launch file is in, or the one in a folder beside it.

    Args:
        file: The launch file.
        beside: Folders that may hold a workspace of the course's name.
    """
    around = [folder for folder in file.resolve().parents if (folder / "src").is_dir()]
    candidates = [*around[:1], *(folder / WORKSPACE for folder in beside)]
    found = [folder for folder in candidates if any((folder / "src").glob("**/package.xml"))]
    return found[0] if found else None
