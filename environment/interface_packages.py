"""The packages with interfaces that the set-up builds: the course's own, and those in the folders of its chapters."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

# Where chapters are written, and where they are in what students are handed.
_CHAPTERS = ("solutions", "exercises")


def interface_packages(root: Path) -> tuple[Path, ...]:
    """Return the folders of all packages, in a stable order; each is called as its package.

    Args:
        root: the folder of the course.
    """
    patterns = ("environment/ros2_ws/src/*", *(f"{name}/*/interfaces/*" for name in _CHAPTERS))
    return tuple(
        folder
        for pattern in patterns
        for folder in sorted(root.glob(pattern))
        if (folder / "package.xml").is_file()
    )


def build_command(
    colcon: Path, python: Path, packages: Sequence[Path], prefix: Path, scratch: Path
) -> list[str | Path]:
    """Return the command that builds packages into a prefix.

    Args:
        colcon: the program.
        python: the interpreter that the interfaces are for.
        packages: the folders of the packages.
        prefix: where they are installed, all merged into one.
        scratch: a folder for what is made on the way.
    """
    # Release defines NDEBUG. With asserts, a field of a wrong type would end a student's process.
    cmake = ["-G", "Ninja", f"-DPython3_EXECUTABLE={python}", "-DCMAKE_BUILD_TYPE=Release"]
    command: list[str | Path] = [colcon, "--log-base", scratch / "colcon-log", "build"]
    command += ["--base-paths", *packages, "--build-base", scratch / "build"]
    command += ["--merge-install", "--install-base", prefix, "--event-handlers", "console_direct+"]
    command += ["--cmake-args", *cmake, "-DBUILD_TESTING=OFF", "--no-warn-unused-cli"]
    return command
