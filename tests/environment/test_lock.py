"""The lock files: in step with what they are made from, complete, and naming no index."""

from __future__ import annotations

import re
import sysconfig
from importlib.metadata import distributions
from typing import TYPE_CHECKING

import pytest

from environment.lock import LOCKS, REQUIREMENTS, ROOT, cut, inputs_digest, recorded_digest, split_blocks

if TYPE_CHECKING:
    from pathlib import Path

RESOLUTION = """\
# a comment of the resolver
numpy==2.4.6 ; python_full_version < '3.12' \\
    --hash=sha256:aa
    # via ros-rclpy
numpy==2.5.5 ; python_full_version >= '3.12' \\
    --hash=sha256:bb
ros-rclpy==7.1.6 \\
    --hash=sha256:cc
ruff==0.17.5 \\
    --hash=sha256:dd
six==1.17.0 \\
    --hash=sha256:ee
"""


def lock_text(name: str) -> str:
    return (REQUIREMENTS / f"{name}.lock").read_text(encoding="utf-8")


def test_a_resolution_is_cut_so_that_nothing_is_lost_or_doubled() -> None:
    bodies = cut(RESOLUTION, course={"six"}, with_dev={"six", "ruff"})
    assert [name for name, _ in split_blocks(bodies["course"])] == ["six"]
    assert [name for name, _ in split_blocks(bodies["dev"])] == ["ruff"]
    assert [name for name, _ in split_blocks(bodies["ros"])] == ["numpy", "numpy", "ros-rclpy"]
    assert bodies["ros"].splitlines() == RESOLUTION.splitlines()[1:8]


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_is_in_step_with_its_inputs(name: str) -> None:
    assert recorded_digest(lock_text(name)) == inputs_digest(), "run: python3 -m environment.lock"


def test_a_changed_dependency_changes_the_digest_and_another_edit_does_not(tmp_path: Path) -> None:
    (tmp_path / "environment/requirements").mkdir(parents=True)
    for name in ("ros.in", "tools.in"):
        (tmp_path / "environment/requirements" / name).write_text((REQUIREMENTS / name).read_text())
    project = (ROOT / "pyproject.toml").read_text()
    (tmp_path / "pyproject.toml").write_text(project)
    assert inputs_digest(tmp_path) == inputs_digest()
    (tmp_path / "pyproject.toml").write_text(project.replace("line-length = 110", "line-length = 99"))
    assert inputs_digest(tmp_path) == inputs_digest()
    (tmp_path / "pyproject.toml").write_text(project.replace('"rich>=', '"richer>='))
    assert inputs_digest(tmp_path) != inputs_digest()


@pytest.mark.parametrize("name", LOCKS)
def test_every_requirement_is_exact_and_hashed(name: str) -> None:
    blocks = split_blocks(lock_text(name))
    assert blocks
    for _, block in blocks:
        assert re.search(r"--hash=sha256:[0-9a-f]{64}", block), block.splitlines()[0]


@pytest.mark.parametrize("name", LOCKS)
def test_no_index_host_or_path_of_a_machine_is_named(name: str) -> None:
    for line in lock_text(name).splitlines():
        assert not re.search(r"://|--(extra-)?index|--find-links|^-f |@ |(^|\s)/\w", line), line


def test_no_requirement_is_in_two_locks() -> None:
    names = [name for lock in LOCKS for name in {name for name, _ in split_blocks(lock_text(lock))}]
    assert len(names) == len(set(names))


def test_no_ros_wheel_is_outside_its_lock() -> None:
    for lock in ("course", "dev"):
        assert not [name for name, _ in split_blocks(lock_text(lock)) if name.startswith("ros-")]


def test_everything_that_pip_installed_here_is_locked() -> None:
    locked = {name for lock in LOCKS for name, _ in split_blocks(lock_text(lock))}
    # What venv itself brings, and the project.
    locked |= {"pip", "ros2-course-autograder"}
    by_pip = [
        found for found in distributions(path=[sysconfig.get_path("purelib")]) if found.read_text("INSTALLER")
    ]
    here = {re.sub(r"[-_.]+", "-", str(found.metadata["Name"])).lower() for found in by_pip}
    assert "jupyterlab" in here
    assert here - locked == set()
