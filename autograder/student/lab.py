"""Starts JupyterLab for a student: the chapters, nbgrader's Validate button, and one ROS domain for the session.

The files in ``lab_config/`` switch off what only instructors need. Jupyter reads them because it searches their folder
before its own. An instructor starts JupyterLab directly (``jupyter lab``), where everything is on.
"""

from __future__ import annotations

import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import check_journal
from autograder.dds_discovery import DOMAIN_VARIABLE, DomainClaim, claim_free_domain, domain_from_environment
from autograder.student.known_classes import is_known

if TYPE_CHECKING:
    from collections.abc import Sequence

SETTINGS = Path(__file__).with_name("lab_config")
"""The folder of Jupyter's settings for students. It switches off *Create Assignment*, formgrader and lists of courses,
which are for instructors. It also gives *Validate* ten minutes per cell and not half a minute, because a check may have
to build a workspace.
"""
PANEL = Path(__file__).with_name("labextensions")
"""The folder of the side panel with the course page, a JupyterLab extension that is ready to be loaded."""
COURSE_PAGE = "course"
"""The path of the course page on the server, below the server's base address."""
START_PAGE = (f"--LabApp.default_url=/{COURSE_PAGE}", f"--LabApp.extra_labextensions_path={PANEL}")
"""The options that make JupyterLab open the course page, with the side panel."""
NOTHING_TO_SAVE = "--ServerApp.contents_manager_class=autograder.student.lab_server.OpenedNotebooks"
"""The option that keeps JupyterLab from marking a notebook as unsaved when it was only opened."""
QUIET = ("--ServerApp.log_level=WARN", "--LabApp.log_level=WARN")
"""Options that hide Jupyter's twenty lines about its start. A student needs only the address, which ``lab_server``
prints.
"""
NOTEBOOKS_VARIABLE = "AUTOGRADER_NOTEBOOKS"
"""The environment variable that tells terminals the folder of the session's notebooks."""
_CONFIG_PATH = "JUPYTER_CONFIG_PATH"
_DISCOVERY = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY")


class NoSuchFolderError(FileNotFoundError):
    """The folder that JupyterLab should open does not exist."""


def open_lab(folder: Path, arguments: Sequence[str] = ()) -> None:
    """Run JupyterLab on ``folder`` until the user ends it.

    Args:
        folder: The folder that the file browser shows.
        arguments: Options for JupyterLab, such as ``--no-browser``.

    Raises:
        NoSuchFolderError: ``folder`` is not a folder.
        ValueError: ``ROS_DOMAIN_ID`` is not a valid domain number.
        NoFreeDomainError: Every domain on this computer is in use.
    """
    if not folder.is_dir():
        raise NoSuchFolderError(
            f"{folder} is not a folder: name the one with your notebooks, or leave --folder out"
        )
    claim = join_domain()
    os.environ[_CONFIG_PATH] = os.pathsep.join(filter(None, (str(SETTINGS), os.environ.get(_CONFIG_PATH))))
    os.chdir(folder)
    os.environ[NOTEBOOKS_VARIABLE] = str(Path.cwd())
    os.environ[check_journal.VARIABLE] = str(check_journal.journal_path(Path.cwd()))
    from jupyterlab.labapp import LabApp
    from nbgrader.apps import NbGrader

    # For *Validate*, which would run the configuration file of the folder.
    NbGrader.load_cwd_config = is_known(Path.cwd())
    try:
        # JupyterLab runs in this process, because the claim on the domain ends with this process.
        LabApp.launch_instance([*START_PAGE, NOTHING_TO_SAVE, *QUIET, *arguments])
    finally:
        end_idle_workers()
        if claim:
            claim.release()


def end_idle_workers() -> None:
    """End the server's threads that read and write files, so that Python does not wait for them.

    Each of these threads (AnyIO's) ends with its request. A request that was in progress when the server was stopped
    never ends, so the terminal would hang after Ctrl-C.
    """
    for thread in threading.enumerate():
        stop = getattr(thread, "stop", None)
        if thread.name == "AnyIO worker thread" and stop is not None:
            stop()


def join_domain() -> DomainClaim | None:
    """Claim a ROS domain on this computer for all kernels and terminals of the session.

    Nodes in the notebooks and terminals of the session can then reach each other, but not other users' nodes. A domain
    that the user has chosen is kept.

    Returns:
        The claim on the domain; None if ``ROS_DOMAIN_ID`` names the domain.

    Raises:
        ValueError: ``ROS_DOMAIN_ID`` is not a valid domain number.
        NoFreeDomainError: Every domain on this computer is in use.
    """
    if not any(os.environ.get(name) for name in _DISCOVERY):
        os.environ[_DISCOVERY[0]] = "LOCALHOST"
    if domain_from_environment() is not None:
        return None
    claim = claim_free_domain()
    os.environ[DOMAIN_VARIABLE] = str(claim.domain)
    return claim
