"""The lock files: in step with what they are made from, complete, and naming no index."""

from __future__ import annotations

import re
import subprocess
import sysconfig
from importlib.metadata import distributions
from typing import TYPE_CHECKING

import pytest

from environment.lock import (
    EXTRAS,
    LOCKS,
    REQUIREMENTS,
    ROOT,
    cut,
    inputs_digest,
    main,
    split_blocks,
)
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

RESOLUTION = cases(__file__, "RESOLUTION")


def lock_text(name: str) -> str:
    return (REQUIREMENTS / f"{name}.lock").read_text(encoding="utf-8")


def test_a_resolution_is_cut_so_that_nothing_is_lost_or_doubled() -> None:
    bodies = cut(RESOLUTION, course={"six"}, extras={"dev": {"six", "ruff"}, "cluster": {"six"}})
    assert [name for name, _ in split_blocks(bodies["course"])] == ["six"]
    assert [name for name, _ in split_blocks(bodies["dev"])] == ["ruff"]
    assert [name for name, _ in split_blocks(bodies["ros"])] == ["numpy", "numpy", "ros-rclpy"]
    assert bodies["ros"].splitlines() == RESOLUTION.splitlines()[1:8]
    assert not split_blocks(bodies["cluster"])


def test_what_two_extras_need_is_in_the_lock_of_each() -> None:
    bodies = cut(RESOLUTION, course=set(), extras={"dev": {"ruff"}, "cluster": {"ruff", "six"}})
    assert [name for name, _ in split_blocks(bodies["dev"])] == ["ruff"]
    assert [name for name, _ in split_blocks(bodies["cluster"])] == ["ruff", "six"]


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_is_in_step_with_its_inputs(name: str) -> None:
    inputs = f"# inputs sha256:{inputs_digest()}"
    assert inputs in lock_text(name).splitlines(), "run: python3 -m environment.lock"


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


def locked(name: str) -> set[str]:
    return {name for name, _ in split_blocks(lock_text(name))}


def test_a_requirement_of_the_course_is_in_no_other_lock() -> None:
    assert not [name for lock in LOCKS if lock != "course" for name in locked(lock) & locked("course")]
    assert not [name for lock in ("dev", *EXTRAS) for name in locked(lock) & locked("ros")]


def test_the_extras_are_not_in_what_everybody_installs() -> None:
    for lock in ("course", "ros", "dev"):
        assert not locked(lock) & {"dask", "distributed", "psycopg", "psycopg-binary"}
    assert "distributed" in locked("cluster")
    assert "psycopg" in locked("postgresql")


def test_no_ros_wheel_is_outside_its_lock() -> None:
    for lock in ("course", "dev", *EXTRAS):
        assert not [name for name, _ in split_blocks(lock_text(lock)) if name.startswith("ros-")]


def test_everything_that_pip_installed_here_is_locked() -> None:
    known = {name for lock in LOCKS for name in locked(lock)}
    # What venv itself brings, and the project.
    known |= {"pip", "ros2-on-the-wire"}
    by_pip = [
        found for found in distributions(path=[sysconfig.get_path("purelib")]) if found.read_text("INSTALLER")
    ]
    here = {re.sub(r"[-_.]+", "-", str(found.metadata["Name"])).lower() for found in by_pip}
    assert "jupyterlab" in here
    assert here - known == set()


def test_a_folder_is_filled_with_the_files_of_the_locks_by_their_hashes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[list[str]] = []

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        asked.append(command)
        (tmp_path / "six-1.17.0-py3-none-any.whl").touch()
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(subprocess, "run", run)
    assert main(["--wheels", str(tmp_path)]) == 0
    (command,) = asked
    assert "--require-hashes" in command
    assert [word for word in command if word.endswith(".lock")] == [
        f"{REQUIREMENTS / name}.lock" for name in LOCKS
    ]
    assert capsys.readouterr().out == f"{tmp_path} has 1 files. Type: ./course setup --wheels {tmp_path}\n"
