"""Students' colcon workspaces: built once for the same sources, and run without sourcing anything by hand."""

from autograder.workspaces.building.colcon import build
from autograder.workspaces.building.result import Build
from autograder.workspaces.running.prefixes import with_prefixes
from autograder.workspaces.sources.packages import BadPackage, Package, find_packages

__all__ = ["BadPackage", "Build", "Package", "build", "find_packages", "with_prefixes"]
