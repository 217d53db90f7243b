"""Where a cgroup can be made, as hosts of several kinds tell it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from autograder.boxes import cgroups
from autograder.boxes.cgroups import Controller

if TYPE_CHECKING:
    import pytest

OLD_OWN = "4:memory:/user/ada\n3:cpu,cpuacct:/\n2:pids:/\n0::/\n"
OLD_MOUNTS = """\
31 30 0:27 / /sys/fs/cgroup/memory rw,relatime - cgroup cgroup rw,memory
32 30 0:28 / /sys/fs/cgroup/pids rw,relatime - cgroup cgroup rw,pids
33 30 0:29 / /proc rw,relatime shared:4 - proc proc rw
"""


def test_one_hierarchy_for_each_controller() -> None:
    found = cgroups._candidates("memory", OLD_OWN, OLD_MOUNTS)
    assert found == [Controller(Path("/sys/fs/cgroup/memory/user/ada"), 1)]
    assert cgroups._candidates("pids", OLD_OWN, OLD_MOUNTS) == [Controller(Path("/sys/fs/cgroup/pids"), 1)]


def test_a_container_that_sees_its_own_part_of_a_hierarchy() -> None:
    mounts = "31 30 0:27 /docker/abc /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory"
    own = "4:memory:/docker/abc/part\n"
    assert cgroups._candidates("memory", own, mounts) == [Controller(Path("/sys/fs/cgroup/memory/part"), 1)]


def test_one_hierarchy_for_all(tmp_path: Path) -> None:
    (tmp_path / "cgroup.controllers").write_text("cpu memory pids\n")
    mounts = f"30 24 0:26 / {tmp_path} rw,nosuid shared:9 - cgroup2 cgroup2 rw,nsdelegate"
    found = cgroups._candidates("pids", "0::/user.slice/session-1.scope\n", mounts)
    # The nearest first: one is delegated to us more likely than what is above it.
    assert [c.base for c in found] == [
        tmp_path / "user.slice" / "session-1.scope",
        tmp_path / "user.slice",
        tmp_path,
    ]
    assert {c.version for c in found} == {2}
    (tmp_path / "cgroup.controllers").write_text("cpu\n")
    assert cgroups._candidates("pids", "0::/user.slice\n", mounts) == []


def test_where_nothing_can_be_made_a_group_is_empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cgroups, "_candidates", lambda *_: [Controller(tmp_path / "nowhere", 2)])
    cgroups.usable.cache_clear()
    try:
        assert cgroups.usable() == {}
        with cgroups.Group(1 << 30, 100) as group:
            assert (group.procs, group.ran_out_of_memory, group.ran_out_of_processes) == ([], False, False)
    finally:
        cgroups.usable.cache_clear()


def test_what_an_earlier_grader_left_is_taken_away(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "autograder-99999999-0").mkdir()
    (tmp_path / "autograder-1-0").mkdir()
    (tmp_path / "mine").mkdir()
    monkeypatch.setattr(cgroups, "_SURELY_LEFT", -1.0)
    cgroups._sweep(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["autograder-1-0", "mine"]
