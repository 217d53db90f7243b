"""Where bubblewrap works, a box can be made: else all other tests of boxes would be skipped, and none would fail."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from autograder.boxes.sandbox import why_impossible

NAMESPACES = ("--unshare-user", "--unshare-pid", "--unshare-net", "--unshare-ipc", "--unshare-uts")


def test_a_box_can_be_made_wherever_bubblewrap_works_alone() -> None:
    bubblewrap = shutil.which("bwrap")
    if bubblewrap is None:
        pytest.skip("bubblewrap is not installed")
    alone = [bubblewrap, *NAMESPACES, "--ro-bind", "/", "/", "--proc", "/proc", "--dev", "/dev", "true"]
    done = subprocess.run(alone, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"bubblewrap cannot work here: {done.stderr}")
    assert why_impossible() == ""
