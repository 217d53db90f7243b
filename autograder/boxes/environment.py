"""The environment variables of a submission's kernel: what Python and ROS need, and nothing else from the host."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from autograder.boxes.mounts import HOME, USER

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

_KEPT = {
    "PATH",
    "LANG",
    "LANGUAGE",
    "TZ",
    "LD_LIBRARY_PATH",
    "PYTHONPATH",
    "PYTHONUTF8",
    "VIRTUAL_ENV",
    "CONDA_PREFIX",
}
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
_NO_THREADS = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Variables that keep numpy's libraries from starting threads when they are loaded.

A fork would lose these threads. A program in which ROS imports numpy would then wait in a busy loop for work that
never comes.
"""


def base_environment(given: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return the environment of a fork server and of every box: what Python and ROS need, and nothing else.

    Args:
        given: The environment to take values from; None for the environment of this process.
    """
    found = (os.environ if given is None else given).items()
    kept = {name: value for name, value in found if name in _KEPT or name.startswith(_KEPT_PREFIXES)}
    own = {"HOME": "/nonexistent", "PYTHONNOUSERSITE": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return {**kept, **_NO_THREADS, **own}


def box_environment(
    extra: Mapping[str, str] | None = None, given: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Return the complete environment of a process in a box.

    Args:
        extra: Variables to set, whatever their values on the host.
        given: The environment to take values from; None for the environment of this process.
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
    """Return the complete environment of a kernel that has its home, temporary and log folders in ``scratch``.

    Args:
        scratch: An existing folder. The folders inside it are created here.
        extra: Variables to set, whatever their values on the host.
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
