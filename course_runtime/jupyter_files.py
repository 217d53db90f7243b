"""Writes JupyterLab's settings in the environment: kernel variables and terminals, and no question about news.

Everything is inside the environment (``.venv/share/jupyter``, ``.venv/etc``). So it applies however JupyterLab is
started, and changes no setting of the user.
"""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

# rclpy logs to standard error, and nbgrader gives no points to a graded cell that writes there. Colors are
# escape sequences in a notebook's output.
KERNEL_VARIABLES = {"RCUTILS_LOGGING_USE_STDOUT": "1", "RCUTILS_COLORIZED_OUTPUT": "0"}

# The name that every notebook of the course asks for.
KERNEL_NAME = "python3"


def kernel_install_options() -> list[str]:
    """Return the options with which ``python -m ipykernel install`` makes the kernel of the course."""
    options = ["--sys-prefix", "--name", KERNEL_NAME, "--display-name", "Python 3 (ipykernel)"]
    return options + [word for name, value in KERNEL_VARIABLES.items() for word in ("--env", name, value)]


def lab_settings() -> dict[str, object]:
    """Return the settings that differ from JupyterLab's own.

    At its first start JupyterLab asks whether it may fetch news. A student should see the course and not a question.
    """
    return {
        "@jupyterlab/apputils-extension:notification": {
            "checkForUpdates": False,
            "doNotDisturbMode": False,
            "fetchNews": "false",
        }
    }


def server_config(root: Path, bash: str | None) -> dict[str, object]:
    """Return the server's configuration, with which ROS is available in terminals.

    Otherwise the profile of a login shell puts the system's programs first, and ``python talker.py`` finds no rclpy.

    Args:
        root: The folder of the course.
        bash: The path of bash; None if there is none, in which case terminals keep their defaults.
    """
    if bash is None:
        return {}
    startup = root / "environment" / "terminal.bashrc"
    return {"ServerApp": {"terminado_settings": {"shell_command": [bash, "--rcfile", str(startup)]}}}


def kernel_config() -> dict[str, object]:
    """Return IPython's configuration of the kernels: one extension, which explains a NameError in a new kernel."""
    return {"IPKernelApp": {"extra_extensions": ["autograder.student.fresh_kernel"]}}


def write_jupyter_files(prefix: Path, root: Path) -> None:
    """Write the settings for the environment at `prefix` of the course at `root`."""
    files = {
        prefix / "share/jupyter/lab/settings/overrides.json": lab_settings(),
        prefix / "etc/jupyter/jupyter_server_config.json": server_config(root, shutil.which("bash")),
        prefix / "etc/ipython/ipython_kernel_config.json": kernel_config(),
    }
    for path, content in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
