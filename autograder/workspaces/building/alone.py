"""A package that is needed, built without the packages of the workspace that it names in package.xml and that fail.

``my_robot_pkg`` depends on ``my_robot_interfaces`` from Lab 1.3 on, and its programs of the labs before import nothing
of it. A definition that does not build yet must not take these labs' points away. What a program does import it finds
where it runs, among the packages that come with the course, or it says that it is missing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.workspaces.building.result import Build, Targets


def or_alone(found: Build, targets: Targets | None, make: Callable[[Build], Build]) -> Build:
    """Build what is needed; where a package fails that is only depended on, what is asked for by itself.

    Args:
        found: The workspace, looked at.
        targets: What is asked for; None for all.
        make: Builds the targets of a workspace with all that they depend on in it.

    Returns:
        The first build, unless it failed and the second did not.
    """
    made = make(found)
    wanted = set(targets(found)) if targets is not None and made.trouble == "build" else set[str]()
    if not wanted or not made.package or made.package in wanted:
        return made
    own = tuple(package for package in found.packages if package.name in wanted)
    # CMake looks for what a package depends on while it is built; setuptools does not.
    if any(package.build_type != "ament_python" for package in own):
        return made
    alone = make(replace(found, packages=own))
    return replace(alone, packages=found.packages) if alone.ok else made
