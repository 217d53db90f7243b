"""Reads ``class.toml``, a file in a class's folder that the instructor may write: what counts, and overlays of ROS."""

from __future__ import annotations

import math
import os
import tomllib
from pathlib import Path
from typing import Annotated, Any

import msgspec

from autograder.grading.grading_errors import GradingError

NAME = "class.toml"


class LateRule(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The cost of being late; ``docs/instructor/points.md`` describes the attributes."""

    percent_per_day: Annotated[float, msgspec.Meta(ge=0, le=100)] = 10.0
    grace_minutes: Annotated[float, msgspec.Meta(ge=0)] = 0.0
    cut_off_days: Annotated[float, msgspec.Meta(ge=0)] = math.inf


class ClassFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The content of the file; ``docs/instructor/points.md`` and ``docs/boxes.md`` describe the attributes."""

    leave_out: tuple[str, ...] = ()
    points: dict[str, float] = {}
    weights: dict[str, float] = {}
    out_of: dict[str, float] = {}
    drop_lowest: Annotated[int, msgspec.Meta(ge=0)] = 0
    overlays: tuple[str, ...] = ()
    due: dict[str, Any] = {}
    extension: dict[str, dict[str, Any]] = {}
    late: LateRule | None = None


def read_class_file(folder: Path) -> ClassFile:
    """Return the content of a class's file; the defaults if the file does not exist.

    Args:
        folder: The folder of the class.

    Raises:
        GradingError: The file cannot be used. The message says what to write.
    """
    path = folder / NAME
    if not path.exists():
        return ClassFile()
    try:
        return msgspec.convert(tomllib.loads(path.read_text(encoding="utf-8-sig")), type=ClassFile)
    except (OSError, ValueError) as error:
        raise GradingError(
            f'{path} cannot be used: {error}. It may contain leave_out = ["EXERCISE"], drop_lowest = 1, '
            'overlays = ["/FOLDER"], and tables named points, weights, out_of, due, late and extension.ASSIGNMENT.'
        ) from error


def read_overlays(folder: Path) -> tuple[Path, ...]:
    """Return the installed workspaces that submissions of a class may use in addition to ROS.

    Args:
        folder: The folder of the class, to which a path in the file may be relative.

    Raises:
        GradingError: The file cannot be used, or names a folder that is not an installed workspace.
    """
    found = tuple(Path(folder, Path(name).expanduser()) for name in read_class_file(folder).overlays)
    for path in found:
        if not path.is_dir():
            raise GradingError(f"{folder / NAME} names the overlay {path}, but this folder does not exist.")
        if not (path / "share" / "ament_index").is_dir() or os.pathsep in str(path):
            raise GradingError(
                f"{folder / NAME} names the overlay {path}, but this folder is not an installed package: it contains "
                "no share/ament_index. Name the folder of each package, such as /home/me/ros2_ws/install/my_package, "
                "or build with --merge-install."
            )
    return found
