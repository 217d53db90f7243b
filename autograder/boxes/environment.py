"""The environment variables of a submission's kernel: what Python and ROS need, and nothing of the host's."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from autograder.boxes.mounts import HOME, USER

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

_KEPT = {"PATH", "LANG", "LANGUAGE", "TZ", "LD_LIBRARY_PATH", "PYTHONPATH", "VIRTUAL_ENV", "CONDA_PREFIX"}
_KEPT_PREFIXES = (
    "LC_",
    "ROS_",
    "RMW_",
    "RCUTILS_",
    "AMENT_",
    "CMAKE_PREFIX",
    "COLCON_PREFIX",
    "FASTDDS_",
    "_ROS_WHEELS_",
)


def base_environment(given: Mapping[str, str] | None = None) -> dict[str, str]:
    """What a fork server starts with: what Python and ROS need of an environment, nothing else.

    Args:
        given: The environment; this process's where None.
    """
    found = (os.environ if given is None else given).items()
    kept = {name: value for name, value in found if name in _KEPT or name.startswith(_KEPT_PREFIXES)}
    return {**kept, "HOME": "/nonexistent", "PYTHONNOUSERSITE": "1", "PYTHONDONTWRITEBYTECODE": "1"}


def box_environment(
    extra: Mapping[str, str] | None = None, given: Mapping[str, str] | None = None
) -> dict[str, str]:
    """The whole environment of a process in a box.

    Args:
        extra: Variables that hold whatever the host says.
        given: See :func:`base_environment`.
    """
    return {
        **base_environment(given),
        "USER": USER,
        "HOME": str(HOME),
        "TMPDIR": "/tmp",
        "ROS_LOG_DIR": str(HOME / ".ros" / "log"),
        "IPYTHONDIR": str(HOME / ".ipython"),
        "JUPYTER_CONFIG_DIR": str(HOME / ".jupyter"),
        **(extra or {}),
    }


def kernel_environment(scratch: Path, extra: Mapping[str, str]) -> dict[str, str]:
    """The whole environment of a kernel whose home, temporary and log folders are in ``scratch``.

    Args:
        scratch: Made before; the folders in it are made here.
        extra: Variables that hold whatever the host says.
    """
    kept = {
        name: value for name, value in os.environ.items() if name in _KEPT or name.startswith(_KEPT_PREFIXES)
    }
    folders = {
        "HOME": scratch / "home",
        "TMPDIR": scratch / "tmp",
        "ROS_LOG_DIR": scratch / "log",
        "IPYTHONDIR": scratch / "home" / ".ipython",
        "JUPYTER_CONFIG_DIR": scratch / "home" / ".jupyter",
    }
    for folder in folders.values():
        folder.mkdir(parents=True, exist_ok=True)
    return {
        **kept,
        **{name: str(folder) for name, folder in folders.items()},
        "PYTHONNOUSERSITE": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
        **extra,
    }
