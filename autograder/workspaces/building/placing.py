"""Put a finished build into its workspace, as if it had been built there."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces.building.artefacts import rename_paths

if TYPE_CHECKING:
    from autograder.workspaces.building.colcon import Build

_LAYOUT = ".colcon_install_layout"


class CannotPlace(RuntimeError):
    """The workspace's install folder cannot take the build. The message says what to do."""


def place(made: Build) -> Path:
    """Copy a build from the cache into ``install`` of its workspace, for terminals to source.

    What is there of the same packages is replaced, what is there of others stays. Libraries that a running program
    has loaded stay loaded: a replaced file is another file, not an overwritten one.

    Returns:
        The install folder.

    Raises:
        ValueError: The build failed.
        CannotPlace: The folder was made with ``--merge-install``, or is not writable.
    """
    if made.install is None:
        raise ValueError("a build that failed has nothing to place")
    target = made.workspace / "install"
    layout = target / _LAYOUT
    if layout.is_file() and layout.read_text(encoding="utf-8").strip() != "isolated":
        raise CannotPlace(f"{target} was built with --merge-install: delete it, and build again")
    try:
        target.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".new-", dir=target) as fresh:
            copied = Path(fresh) / "install"
            shutil.copytree(made.install, copied, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
            rename_paths(copied, str(made.install), str(target))
            for entry in sorted(copied.iterdir()):
                _replace(target / entry.name, entry)
    except OSError as error:
        raise CannotPlace(f"{target} cannot be written: {error.strerror}") from error
    return target


def _replace(old: Path, new: Path) -> None:
    if old.is_dir() and not old.is_symlink():
        shutil.rmtree(old)
    new.replace(old)
