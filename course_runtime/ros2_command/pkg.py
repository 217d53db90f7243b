"""`ros2 pkg list`, `prefix` and `executables`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from course_runtime.ros2_command.commands import Outcome, Verb

if TYPE_CHECKING:
    import argparse


def package_prefix(package: str) -> Path | None:
    """Return the install folder of a package; None if no sourced workspace has the package."""
    from ament_index_python.packages import PackageNotFoundError, get_package_prefix

    try:
        return Path(get_package_prefix(package))
    except (PackageNotFoundError, ValueError):
        return None


def executable_paths(package: str) -> list[Path]:
    """Return the programs that `ros2 run` can start, in order.

    Raises:
        RuntimeError: No sourced workspace has the package.
    """
    prefix = package_prefix(package)
    if prefix is None:
        raise RuntimeError(f"Package '{package}' not found")
    return sorted(
        path
        for path in (prefix / "lib" / package).rglob("*")
        if path.is_file() and os.access(path, os.X_OK) and not _in_hidden_folder(path, prefix)
    )


def _in_hidden_folder(path: Path, prefix: Path) -> bool:
    return any(part.startswith(".") for part in path.relative_to(prefix).parent.parts)


def _no_arguments(parser: argparse.ArgumentParser) -> None:
    del parser


def _package_names() -> list[str]:
    from ament_index_python.packages import get_packages_with_prefixes

    return sorted(get_packages_with_prefixes())


def _list(args: argparse.Namespace) -> Outcome:
    del args
    for name in _package_names():
        print(name)
    return None


def _prefix_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("package_name", help="The package name")
    parser.add_argument("--share", action="store_true", help="Show share directory for the package")


def _prefix(args: argparse.Namespace) -> Outcome:
    prefix = package_prefix(args.package_name)
    if prefix is None:
        return "Package not found"
    print(prefix / "share" / args.package_name if args.share else prefix)
    return None


def _executables_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("package_name", nargs="?", help="The package name")
    parser.add_argument("--full-path", action="store_true", help="Show full path of each executable")


def _executables(args: argparse.Namespace) -> Outcome:
    names = _package_names() if args.package_name is None else [args.package_name]
    for name in names:
        for path in executable_paths(name):
            print(path if args.full_path else f"{name} {path.name}")
    return None


VERBS = {
    "executables": Verb(_executables_arguments, _executables),
    "list": Verb(_no_arguments, _list),
    "prefix": Verb(_prefix_arguments, _prefix),
}
