"""The environment of a judge's process."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.judge.ros_setup import provide_log_folder

if TYPE_CHECKING:
    import pytest


def test_the_folder_of_ros_logs_is_this_processs_own_whatever_another_user_has_put_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    (tmp_path / f"autograder-ros-logs-{os.getuid()}").touch()
    monkeypatch.setenv("ROS_LOG_DIR", "")
    provide_log_folder()
    made = Path(os.environ["ROS_LOG_DIR"])
    assert made.parent == tmp_path
    assert made.stat().st_mode & 0o777 == 0o700
    provide_log_folder()
    assert os.environ["ROS_LOG_DIR"] == str(made)
