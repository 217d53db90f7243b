"""Two never write into one gradebook, whichever command or button started them."""

from __future__ import annotations

import os
import re
import select
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from nbgrader.converters import NbGraderException
from test_nbgrader_and_ours import nbgrader_autograde, nbgrader_generate_feedback
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import ClassBusy
from autograder.grading.running import execution_backends
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

WHO = rf"process {os.getpid()}, since \d{{4}}-\d\d-\d\d \d\d:\d\d:\d\d"

HOLD = cases(__file__, "HOLD")

PATIENCE = 120.0
"""Seconds after which two batches that both stand still have failed."""
HELD = cases(__file__, "HELD")
"""A batch in a process of its own that stands still until its input is closed."""


def is_running(process: subprocess.Popen[str]) -> bool:
    return process.poll() is None


def test_the_command_says_who_is_at_work_and_since_when(tiny: TinyClass) -> None:
    with ClassDirectory(tiny.path).lock():
        words = [sys.executable, "-W", "ignore", "-m", "autograder", "grade", str(tiny.path)]
        second = subprocess.run(words, capture_output=True, text=True, check=False)
    assert second.returncode == 2
    assert re.search(rf"Another run is grading {re.escape(str(tiny.path))} \({WHO}\)", second.stderr)
    assert len(second.stderr.splitlines()) == 1


def test_a_lock_by_another_path_is_the_same_lock(tiny: TinyClass, tmp_path: Path) -> None:
    (tmp_path / "shortcut").symlink_to(tiny.path)
    with (
        ClassDirectory(tiny.path).lock(),
        pytest.raises(ClassBusy, match=WHO),
        ClassDirectory(tmp_path / "shortcut").lock(),
    ):
        pass


@pytest.mark.parametrize(
    "left", [b"", b"12345", b'{"pid":1,"host":"elsewhere","since":"2020-01-01 00:00:00"}', b"\xff\x00" * 500]
)
def test_a_file_that_a_killed_run_left_behind_means_nothing(
    tiny: TinyClass, fake_engine: FakeEngine, left: bytes
) -> None:
    (tiny.path / ".autograder" / "lock").write_bytes(left)
    tiny.submit("ada")
    tiny.grade()
    assert tiny.scores("ada")[TALKER] == 10


def test_a_killed_runs_child_does_not_hold_the_lock(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada")
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tiny.path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as holder:
        assert holder.stdout is not None
        child = int(holder.stdout.readline())
        with pytest.raises(ClassBusy, match=f"process {holder.pid}, since"):
            tiny.grade()
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        os.kill(child, 0)  # it lives
        tiny.grade()
        assert holder.stdin is not None
    assert tiny.scores("ada")[TALKER] == 10


def test_the_lock_is_free_after_a_run_that_failed(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    def fail(_: object) -> None:
        raise RuntimeError("no more")

    tiny.submit("ada")
    fake_engine.before = fail
    with pytest.raises(RuntimeError):
        tiny.grade()
    fake_engine.before = lambda _: None
    assert tiny.grade().exit_code == 0


# -- plain nbgrader
# ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("conversion", [nbgrader_autograde, nbgrader_generate_feedback])
def test_formgraders_buttons_do_nothing_while_a_batch_runs(
    tiny: TinyClass, fake_engine: FakeEngine, conversion: Any
) -> None:
    """In formgrader they run in the server's process; here, that of the batch itself."""
    tiny.submit("ada", 3, 4)
    tiny.submit("ben", 5, 6)
    tiny.grade(feedback=True)
    tiny.submit("ben", 7, 8)

    def press(_: object) -> None:
        with pytest.raises(NbGraderException, match=f"Another run is grading .*{WHO}"):
            conversion(tiny)
        assert tiny.scores("ada") == {TALKER: 3, LISTENER: 4}
        assert not (tiny.path / "feedback" / "ben" / "lab_1_2").exists()

    fake_engine.before = press
    assert tiny.grade(feedback=True).exit_code == 0
    assert tiny.scores("ada") == {TALKER: 3, LISTENER: 4}
    assert tiny.scores("ben") == {TALKER: 7, LISTENER: 8}
    fake_engine.before = lambda _: None
    conversion(tiny)


def test_a_batch_does_nothing_while_nbgrader_grades(
    tiny: TinyClass, fake_engine: FakeEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada", 3, 4)
    usual = execution_backends.execute_all

    def meanwhile(*args: Any, **kw: Any) -> Any:
        with pytest.raises(ClassBusy, match=WHO):
            tiny.grade()
        return usual(*args, **kw)

    monkeypatch.setattr(execution_backends, "execute_all", meanwhile)
    nbgrader_autograde(tiny)
    assert tiny.scores("ada") == {TALKER: 3, LISTENER: 4}
    assert tiny.grade().executed == 0


# -- two at once
# ---------------------------------------------------------------------------------------------------------


def test_two_batches_started_at_once_on_one_class(tiny: TinyClass, with_fake_judge: str) -> None:
    right = {"ada": 1, "ben": 2, "cleo": 3}
    for student, points in right.items():
        tiny.submit(student, points)
    batches = [
        subprocess.Popen(
            [sys.executable, "-W", "ignore", "-c", HELD, str(tiny.path)],
            stdin=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in "ab"
    ]
    select.select([os.pidfd_open(one.pid) for one in batches], [], [], PATIENCE)
    # One has ended; the other goes on as soon as its input is closed.
    ended = [(process, process.communicate()[1]) for process in sorted(batches, key=is_running)]
    (_, said), (done, _) = ended
    assert "Another run is grading" in said
    assert done.returncode == 0
    assert {student: tiny.scores(student)[TALKER] for student in right} == right
