"""What building a workspace brought, as data."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.workspaces.running.prefixes import package_prefixes

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


Targets = Callable[[Build], Iterable[str]]
"""Says of a workspace that was looked at which of its packages are needed; none of them means all."""
