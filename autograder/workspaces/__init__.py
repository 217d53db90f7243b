"""Students' colcon workspaces: built once for the same sources, and run without sourcing anything by hand."""

from autograder.workspaces.building import Build, build
from autograder.workspaces.packages import BadPackage, Package, find_packages
from autograder.workspaces.prefixes import with_prefixes

__all__ = ["BadPackage", "Build", "Package", "build", "find_packages", "with_prefixes"]
