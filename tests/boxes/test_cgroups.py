"""Where a cgroup can be made, as hosts of several kinds tell it."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from autograder.boxes import cgroups
from autograder.boxes.cgroups import Controller
from tests.cases import cases

OLD_OWN = cases(__file__, "OLD_OWN")
OLD_MOUNTS = cases(__file__, "OLD_MOUNTS")


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


BUSY = "import os, sys\nos.sched_setaffinity(0, {int(sys.argv[1])})\nprint(flush=True)\nwhile True: pass"


@pytest.mark.skipif("cpu" not in cgroups.usable(), reason="this host lets us make no cgroups with a share")
def test_many_processes_of_a_group_have_one_share(monkeypatch: pytest.MonkeyPatch) -> None:
    """On one processor, so that both groups want the same; what others want of it they have from both alike."""
    processor = str(min(os.sched_getaffinity(0)))
    with contextlib.ExitStack() as stack:
        many, one = (stack.enter_context(cgroups.Group(1 << 30, 100)) for _ in range(2))
        for group, number in ((many, 9), (one, 1)):
            for _ in range(number):
                busy = subprocess.Popen([sys.executable, "-S", "-c", BUSY, processor], stdout=subprocess.PIPE)
                stack.callback(busy.communicate)
                stack.callback(busy.kill)
                assert busy.stdout is not None
                busy.stdout.readline()
                for procs in group.procs:
                    Path(procs).write_text(str(busy.pid))
        began = [group.cpu_seconds or 0.0 for group in (many, one)]
        while (many.cpu_seconds or 0.0) - began[0] < 1.0:
            time.sleep(0.05)
        used = [(group.cpu_seconds or 0.0) - start for group, start in zip((many, one), began, strict=True)]
        assert used[1] > used[0] / 3, "one process has a ninth of what nine have together"


def test_version_2_counts_processor_time_in_every_group(tmp_path: Path) -> None:
    with cgroups.Group(1 << 30, 100, {"pids": Controller(tmp_path, 2)}) as group:
        folder = Path(group.procs[0]).parent
        folder.joinpath("cpu.stat").write_text("usage_usec 2500000\nuser_usec 1\nsystem_usec 2\n")
        assert group.cpu_seconds == 2.5
