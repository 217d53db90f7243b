"""Substitutions that find packages."""

from __future__ import annotations

import os
import shutil
from typing import TYPE_CHECKING

from launch.substitution import (
    SomeSubstitutionsType,
    Substitution,
    SubstitutionFailure,
    describe,
    normalize,
    perform,
)
from launch.unsupported import names_elsewhere

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

__all__ = ["ExecutableInPackage", "FindPackagePrefix", "FindPackageShare"]
__getattr__ = names_elsewhere("launch_ros.substitutions", ("FindPackage", "Parameter"))


class FindPackagePrefix(Substitution):
    """The install folder of a package."""

    def __init__(self, package: SomeSubstitutionsType) -> None:
        self.package = normalize(package)

    def describe(self) -> str:
        """Return the name of the class with the package."""
        return f"{type(self).__name__}(pkg={describe(self.package)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the folder.

        Raises:
            SubstitutionFailure: No sourced workspace has the package.
        """
        from ament_index_python.packages import PackageNotFoundError, get_package_prefix

        name = perform(context, self.package)
        try:
            return str(get_package_prefix(name))
        except (PackageNotFoundError, ValueError) as error:
            raise SubstitutionFailure(str(error.args[0])) from error


class FindPackageShare(FindPackagePrefix):
    """The share folder of a package, which holds its launch files."""

    def perform(self, context: LaunchContext) -> str:
        """Return the folder."""
        return f"{super().perform(context)}/share/{perform(context, self.package)}"


class ExecutableInPackage(FindPackagePrefix):
    """A program of a package."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        super().__init__(package)
        self.executable = normalize(executable)

    def describe(self) -> str:
        """Return the package and the program."""
        return f"ExecInPkg(pkg={describe(self.package)}, exec={describe(self.executable)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the path.

        Raises:
            SubstitutionFailure: The package does not exist, or has no such program.
        """
        prefix = super().perform(context)
        package, executable = perform(context, self.package), perform(context, self.executable)
        folder = f"{prefix}/lib/{package}"
        if not os.path.exists(folder):  # noqa: PTH110
            raise SubstitutionFailure(
                f"package '{package}' found at '{prefix}', but libexec directory '{folder}' does not exist"
            )
        found = shutil.which(executable, path=folder)
        if found is None:
            raise SubstitutionFailure(
                f"executable '{executable}' not found on the libexec directory '{folder}' "
            )
        return found
