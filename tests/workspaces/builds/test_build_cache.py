"""The cache: one owner, one builder at a time, no half-built entry, a bound on its size."""

from __future__ import annotations

import contextlib
import fcntl
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from autograder.workspaces.builds import build_cache
from autograder.workspaces.builds.build_artifacts import BLOCK
from tests.cases import cases


def fill(key: str, size: int = 10) -> None:
    with build_cache.entry(key, build_cache.root()) as entry:
        (entry.folder / "file").write_bytes(b"x" * size)
        entry.finish()


def test_an_interrupted_entry_does_not_count(empty_cache: Path) -> None:
    with contextlib.suppress(KeyboardInterrupt), build_cache.entry("a", build_cache.root()) as entry:
        (entry.folder / "half").touch()
        raise KeyboardInterrupt
    assert not (empty_cache / "a").exists()
    with build_cache.entry("a", build_cache.root()) as entry:
        assert not entry.complete


def test_an_entry_counts_for_the_key_that_it_was_built_for_alone(empty_cache: Path) -> None:
    fill("a")
    (empty_cache / "a").rename(empty_cache / "b")
    assert not build_cache.is_complete("b", empty_cache)
    with build_cache.entry("b", build_cache.root()) as entry:
        assert not entry.complete
        assert list(entry.folder.iterdir()) == []


def test_what_a_killed_builder_left_is_removed(empty_cache: Path) -> None:
    (empty_cache / "a").mkdir(parents=True)
    empty_cache.chmod(0o700)
    (empty_cache / "a" / "half").touch()
    with build_cache.entry("a", build_cache.root()) as entry:
        assert not entry.complete
        assert list(entry.folder.iterdir()) == []


def test_the_build_of_a_killed_builder_is_ended_before_another_begins(empty_cache: Path) -> None:
    """As where JupyterLab restarts a kernel in a check: colcon has a session of its own, and would go on."""
    program = cases(__file__, "the_build_of_a_killed_builder_is_ended_before_another_begins")
    killed = subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, check=False)
    assert killed.returncode == -signal.SIGKILL
    writing = int(killed.stdout)
    with build_cache.entry("a", build_cache.root()) as entry:
        assert state_of(writing) in ("", "Z")  # nobody may have waited for it yet
        assert list(entry.folder.iterdir()) == []


def state_of(pid: int) -> str:
    """A process's state, as ps shows it; empty where there is none."""
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return ""


def test_two_builders_of_one_key_take_turns() -> None:
    built: list[str] = []
    entered = threading.Event()

    def builder(name: str) -> None:
        with build_cache.entry("a", build_cache.root()) as entry:
            entered.set()
            if not entry.complete:
                built.append(name)
                entry.finish()

    with build_cache.entry("a", build_cache.root()) as entry:
        waiting = threading.Thread(target=builder, args=("second",))
        waiting.start()
        assert not entered.wait(0.1)
        entry.finish()
    waiting.join(timeout=180)
    assert entered.is_set()
    assert built == []


def test_who_waits_for_an_entry_can_give_up(empty_cache: Path) -> None:
    empty_cache.mkdir(mode=0o700)
    with build_cache.entry("a", build_cache.root()) as held:
        with (
            pytest.raises(build_cache.GivenUp),
            build_cache.entry("a", build_cache.root(), cancelled=lambda: True),
        ):
            pass
        held.finish()
    with build_cache.entry("a", build_cache.root(), cancelled=lambda: True) as entry:
        assert entry.complete


def test_a_folder_that_others_may_write_to_is_not_used(empty_cache: Path) -> None:
    empty_cache.mkdir()
    empty_cache.chmod(0o777)
    assert build_cache.root() != empty_cache
    assert build_cache.root() == build_cache.root()
    empty_cache.chmod(0o700)
    assert build_cache.root() == empty_cache


def test_a_link_to_a_folder_is_not_used(empty_cache: Path, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    empty_cache.symlink_to(tmp_path / "elsewhere")
    assert build_cache.root() != empty_cache


def test_the_oldest_go_first_and_those_in_use_stay(empty_cache: Path) -> None:
    for number, key in enumerate("abc"):
        fill(key, size=100)
        os.utime(empty_cache / key / "complete", (number, number))
    each = 100 + len("complete") + 3 * BLOCK
    assert build_cache.make_room(empty_cache, limit=3 * each) == []
    assert build_cache.make_room(empty_cache, limit=3 * each - 100) == ["a"]
    fill("d", size=1000)
    assert build_cache.make_room(empty_cache, limit=0) == ["b", "c"]
    assert (empty_cache / "d").is_dir()


def test_an_entry_that_somebody_holds_is_not_removed(empty_cache: Path) -> None:
    fill("a")
    os.utime(empty_cache / "a" / "complete", (0, 0))
    with build_cache.entry("a", build_cache.root()):
        os.utime(empty_cache / "a" / "complete", (0, 0))
        assert build_cache.make_room(empty_cache, limit=0) == []


def test_what_another_worker_removes_meanwhile_does_not_count(
    empty_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fill("a")
    walked = list(os.walk(empty_cache / "a"))
    (empty_cache / "a" / "file").unlink()
    monkeypatch.setattr(os, "walk", lambda _: walked)
    assert build_cache.make_room(empty_cache, limit=0) == []


def test_locks_go_with_their_entries(empty_cache: Path) -> None:
    fill("a")
    os.utime(empty_cache / "a" / "complete", (0, 0))
    with contextlib.suppress(ValueError), build_cache.entry("failed", build_cache.root()):
        raise ValueError
    with build_cache.entry("held", build_cache.root()):
        assert build_cache.make_room(empty_cache, limit=0) == ["a"]
        assert [file.name for file in empty_cache.iterdir() if file.is_file()] == ["held.lock"]
    assert list(empty_cache.iterdir()) == []


def test_who_waited_for_a_lock_that_was_removed_takes_the_one_that_is_there(empty_cache: Path) -> None:
    """Else two would build one entry: the lock that was removed is nobody else's any more."""
    empty_cache.mkdir(mode=0o700)
    lock = empty_cache / "a.lock"
    waiting = threading.Event()

    def cancelled() -> bool:
        waiting.set()
        return False

    def build() -> None:
        with build_cache.entry("a", build_cache.root(), cancelled) as entry:
            held.append(os.path.samestat(os.fstat(entry.lock), lock.stat()))

    held: list[bool] = []
    with lock.open("a") as first:
        fcntl.flock(first, fcntl.LOCK_EX)
        builder = threading.Thread(target=build)
        builder.start()
        assert waiting.wait(timeout=60)
        lock.unlink()
    builder.join(timeout=60)
    assert held == [True]


def test_the_folder_in_the_place_of_a_cache_goes_with_its_process(empty_cache: Path) -> None:
    empty_cache.mkdir()
    empty_cache.chmod(0o777)
    uses = "import os; from autograder.workspaces.builds import build_cache"
    code = f"{uses}; print(build_cache.root(), flush=True); os.fork()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    folder = Path(done.stdout.strip())
    assert folder != empty_cache
    assert not folder.exists()
