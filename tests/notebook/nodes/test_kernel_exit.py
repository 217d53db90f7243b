"""The end of a kernel: with whatever spins, it exits at once, with code 0 and nothing on standard error."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from jupyter_client.manager import KernelManager

from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = pytest.mark.ros

SET_UP = cases(__file__, "SET_UP")

LEFT_BEHIND = cases(__file__, "LEFT_BEHIND")


@pytest.mark.parametrize("left", LEFT_BEHIND.values(), ids=LEFT_BEHIND.keys())
def test_a_process_ends_cleanly(left: str, domain: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", f"{SET_UP}\n{left}\nbegun.wait(20)"],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_kernel_ends_cleanly(domain: int, tmp_path: Path) -> None:
    log = tmp_path / "stderr"
    with log.open("w") as stderr:
        manager = KernelManager(kernel_name="python3")
        manager.start_kernel(env={**os.environ, "ROS_DOMAIN_ID": str(domain)}, stderr=stderr)
        client = manager.blocking_client()
        client.start_channels()
        client.wait_for_ready(timeout=180)
        for cell in (SET_UP, *list(LEFT_BEHIND.values())[:2], "begun.wait(20)"):
            client.execute_interactive(cell, timeout=180, output_hook=lambda message: None)
        client.shutdown(reply=False)
        process = manager.provisioner.process  # type: ignore[union-attr]
        assert process.wait(timeout=180) == 0
        client.stop_channels()
        manager.cleanup_resources()
    # ipykernel's own word about its transport is not ours.
    said = [line for line in log.read_text().splitlines() if "without encryption" not in line]
    assert said == []
