"""The preparations of ``autograder lab`` before JupyterLab takes over."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import threading
from pathlib import Path

import anyio.to_thread
import pytest
from jupyter_core.paths import jupyter_config_path
from jupyter_server.services.config import ConfigManager
from jupyterlab.labapp import LabApp
from jupyterlab_server.config import get_page_config
from nbgrader.server_extensions.validate_assignment.handlers import ValidateAssignmentHandler

from autograder import check_journal, exercises
from autograder.dds_discovery import claim_free_domain
from autograder.student import known_classes
from autograder.student.lab import (
    NOTEBOOKS_VARIABLE,
    NOTHING_TO_SAVE,
    PANEL,
    QUIET,
    NoSuchFolderError,
    end_idle_workers,
    open_lab,
)

ROS_VARIABLES = ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY")
VARIABLES = (
    *ROS_VARIABLES,
    "JUPYTER_CONFIG_PATH",
    check_journal.VARIABLE,
    NOTEBOOKS_VARIABLE,
)
START = [
    "--LabApp.default_url=/course",
    f"--LabApp.extra_labextensions_path={PANEL}",
    NOTHING_TO_SAVE,
    *QUIET,
]


class Started:
    """What JupyterLab would have started with."""

    def __init__(self, argv: list[str]) -> None:
        self.argv = argv
        self.folder = Path.cwd()
        self.environ = dict(os.environ)
        labextensions = Path(sys.prefix) / "share/jupyter/labextensions"
        self.disabled = get_page_config([str(labextensions)])["disabledExtensions"]
        self.config_path = jupyter_config_path()
        # As jupyterlab_server's settings_utils reads it.
        self.settings = ConfigManager(config_dir_name="labconfig").get("default_setting_overrides")  # type: ignore[no-untyped-call]
        self.validate = ValidateAssignmentHandler.load_config(None)
        self.domain_is_held = not _can_claim(int(os.environ.get("ROS_DOMAIN_ID", "0")))


def _can_claim(domain: int) -> bool:
    try:
        claim_free_domain([domain]).release()
    except RuntimeError:
        return False
    return True


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Started]:
    """Collects what JupyterLab is started with, and forgets it all afterwards."""
    found: list[Started] = []
    for name in VARIABLES:
        # Set first, so that what the code under test sets is taken back as well.
        monkeypatch.setenv(name, "")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(LabApp, "launch_instance", lambda argv: found.append(Started(argv)))
    return found


def test_a_session_is_this_students_alone_and_has_what_a_student_needs(
    started: list[Started], tmp_path: Path
) -> None:
    open_lab(tmp_path, ["--no-browser"])
    (session,) = started
    assert session.domain_is_held
    assert session.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
    off = {name.partition(":")[2] for name in session.disabled if name.startswith("@jupyter/nbgrader:")}
    assert off == {"assignment-list", "course-list", "create-assignment", "formgrader", "menu"}
    assert session.validate.Execute.timeout >= max(exercise.limit for exercise in exercises.unbroken())
    # Cards name lines.
    assert session.settings["@jupyterlab/notebook-extension:tracker"]["codeCellConfig"]["lineNumbers"]
    assert (session.folder, session.argv) == (tmp_path, [*START, "--no-browser"])
    assert session.environ[NOTEBOOKS_VARIABLE] == str(tmp_path)
    assert session.environ[check_journal.VARIABLE] == str(tmp_path / check_journal.NAME)


def test_validate_runs_the_configuration_only_of_a_known_class(
    started: list[Started], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    (tmp_path / "nbgrader_config.py").write_text("c.Exchange.root = 'from the folder'")
    open_lab(tmp_path)
    assert not started[0].validate.Exchange
    known_classes.remember(tmp_path)
    open_lab(tmp_path)
    assert started[1].validate.Exchange.root == "from the folder"


def test_two_sessions_have_two_domains(
    started: list[Started], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def start_another(argv: list[str]) -> None:
        started.append(Started(argv))
        if len(started) == 1:
            monkeypatch.setenv("ROS_DOMAIN_ID", "")
            open_lab(tmp_path)

    monkeypatch.setattr(LabApp, "launch_instance", start_another)
    open_lab(tmp_path)
    assert len({session.environ["ROS_DOMAIN_ID"] for session in started}) == 2


def test_what_the_user_chose_stays(
    started: list[Started], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "17")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    monkeypatch.setenv("JUPYTER_CONFIG_PATH", "/my/settings")
    open_lab(tmp_path)
    assert started[0].environ["ROS_DOMAIN_ID"] == "17"
    assert started[0].environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "SUBNET"
    assert "/my/settings" in started[0].config_path


def test_a_request_that_was_never_answered_does_not_keep_the_server_alive() -> None:
    before = set(threading.enumerate())
    loop = asyncio.new_event_loop()

    async def request() -> None:
        await anyio.to_thread.run_sync(loop.call_soon_threadsafe, loop.stop)
        await asyncio.Event().wait()

    task = loop.create_task(request())
    loop.run_forever()
    loop.run_until_complete(asyncio.sleep(0))  # the thread is idle, and its request goes on
    (worker,) = set(threading.enumerate()) - before
    end_idle_workers()
    worker.join(60)
    assert not worker.is_alive()
    assert not task.done()
    task.cancel()
    loop.run_until_complete(asyncio.wait([task]))
    loop.close()


def test_a_folder_that_is_not_there_is_a_clear_error(tmp_path: Path) -> None:
    with pytest.raises(NoSuchFolderError, match="is not a folder"):
        open_lab(tmp_path / "nowhere")


def test_the_command_ends_with_2_and_says_what_to_correct() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "autograder", "lab", "--no-browser"],
        env=os.environ | {"ROS_DOMAIN_ID": "one"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "ROS_DOMAIN_ID is 'one'" in done.stderr
