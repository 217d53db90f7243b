"""What building a workspace brought, as data."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import re2

from autograder.workspaces.running.prefixes import package_prefixes, python_folders

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.workspaces.sources.packages import Package


@dataclass(frozen=True)
class Build:
    """What building a workspace brought.

    Attributes:
        workspace: Its folder.
        ok: Whether every package was built.
        install: Where the packages are installed; empty where it failed.
        packages: The packages of the workspace, as their files describe them.
        unusable: What is wrong with those that cannot be used.
        seconds: Wall time that it took.
        reused: Whether the same sources had been built before.
        trouble: ``"no_workspace"``, ``"no_package"``, ``"bad_package"`` or ``"build"``; empty where it is
            well.
        package: The package that failed, else empty.
        line: The one line that matters of a failure.
        log: The log of a failure.
    """

    workspace: Path
    ok: bool
    install: Path | None = None
    packages: tuple[Package, ...] = ()
    unusable: tuple[str, ...] = ()
    seconds: float = 0.0
    reused: bool = False
    trouble: str = ""
    package: str = ""
    line: str = ""
    log: str = field(default="", repr=False)

    @property
    def prefixes(self) -> list[Path]:
        """One folder for each installed package."""
        return package_prefixes(self.install) if self.install else []

    def programs(self, package: str) -> tuple[str, ...]:
        """The names of the programs that ``ros2 run`` finds of an installed package; empty where it is none."""
        folders = [prefix / "lib" / package for prefix in self.prefixes if prefix.name == package]
        return tuple(sorted(file.name for folder in folders for file in folder.glob("*") if file.is_file()))

    def entry_points(self, package: str) -> tuple[str, ...]:
        """The entry points of an installed Python package, as ``name = module:function``, however it names them."""
        folders = [f for prefix in self.prefixes if prefix.name == package for f in python_folders(prefix)]
        files = [file for folder in folders for file in folder.glob("*/entry_points.txt")]
        texts = (file.read_text(encoding="utf-8", errors="replace") for file in files)
        return tuple(
            line
            for text in texts
            for line in text.splitlines()
            if re2.fullmatch(r"\S+ = [\w.]+:[\w.]+", line)
        )


Targets = Callable[[Build], Iterable[str]]
"""Says of a workspace that was looked at which of its packages are needed; none of them means all."""
