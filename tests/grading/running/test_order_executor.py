"""Real workers and kernels with a judge that needs no ROS."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest.mock import Mock

import msgspec
import psutil
import pytest
from tiny_class import GRADE, LISTENER, TALKER, TinyClass

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import Cell, CellCheck, CellRun, Execution
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_task import Task
from autograder.grading.running import order_executor, task_dispatcher
from autograder.grading.running.task_execution import _a_check_was_stopped
from autograder.grading.running.worker_messages import ADDRESS, Answered, Drop, Give, Joined, News, Order
from autograder.messages.json_lines import Lines
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator


def leftovers(tiny: TinyClass) -> list[psutil.Process]:
    """The executor has the scratch folder of its class in its command, and supervisors have mounted something there."""
    scratch = f"{tempfile.gettempdir()}/{ClassDirectory(tiny.path).scratch_prefix}"
    found = []
    for process in psutil.process_iter(["cmdline", "status"]):
        if process.info["status"] == psutil.STATUS_ZOMBIE:
            continue
        words = process.info["cmdline"] or []
        if any(scratch in word for word in words) or scratch in mounts(process.pid):
            found.append(process)
    return found


def mounts(pid: int) -> str:
    """What a process sees mounted where."""
    try:
        return Path(f"/proc/{pid}/mountinfo").read_text()
    except OSError:
        return ""


def test_points_come_from_the_judge_whatever_a_submission_costs_and_nothing_is_left(
    tiny: TinyClass, with_fake_judge: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ada's costs the worker, Cleo's the judge, Dora's raises, and Eve's looks for the class and other submissions."""
    monkeypatch.setattr(task_dispatcher, "ATTEMPTS", 2)  # each time a worker is lost another one has to start
    above = "(p / f for p in pathlib.Path('.').resolve().parents for f in ('gradebook.db', 'submitted'))"
    sees = f"10 if any(path.exists() for path in {above}) else 1"
    answers: tuple[tuple[str, object], ...] = (
        *(("ada", "'kill worker'"), ("ben", 8), ("cleo", "'die'"), ("dora", "1/0"), ("eve", sees)),
    )
    for student, answer in answers:
        tiny.submit(student, answer, 9)
    report = tiny.grade(judge=with_fake_judge, jobs=1)
    states = {row.student: row.state for row in report.rows if row.exercise == "lab_1_2.talker"}
    assert [states[one] for one in ("ada", "ben", "cleo", "dora")] == [
        "not_checked",
        "failed",
        "not_checked",
        "failed",
    ]
    assert [row.diagnosis for row in report.rows if row.student == "dora"] == ["crashed", "wrong_text"]
    found = {student: tuple(tiny.scores(student)[name] for name in (TALKER, LISTENER)) for student in states}
    assert found == {"ada": (0, 0), "ben": (8, 9), "cleo": (0, 9), "dora": (0, 9), "eve": (1, 9)}
    assert leftovers(tiny) == []
    assert not list(Path(tempfile.gettempdir()).glob(f"{ClassDirectory(tiny.path).scratch_prefix}*"))


@pytest.mark.parametrize(
    ("check", "ended", "stopped"),
    [
        (CellCheck("one", "One", 10, 10, 60), Ended.TIMED_OUT, True),
        (CellCheck("one", "One", 10, 10, 60), Ended.DONE, False),
        (CellCheck("one", "One", 10, 10, 60, asserts=True), Ended.TIMED_OUT, False),
        (None, Ended.TIMED_OUT, False),
    ],
)
def test_a_check_of_the_judge_that_was_stopped_says_nothing_while_others_ran_beside(
    check: CellCheck | None, ended: Ended, stopped: bool
) -> None:
    execution = Execution((CellRun(Ended.DONE), CellRun(ended)))
    assert _a_check_was_stopped([Cell("x = 1"), Cell("check(x)", check=check)], execution) is stopped


def test_a_failure_on_a_crowded_machine_counts_only_where_nothing_else_runs(
    tiny: TinyClass, with_fake_judge: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    notes = tmp_path / "notes"
    monkeypatch.setenv("NOTES_OF_THE_FAKE_JUDGE", str(notes))
    tiny.submit("ada", "'crowded 6'", 10)
    tiny.submit("ben", 5, 10)
    tiny.grade(judge=with_fake_judge, jobs=2)
    assert (tiny.scores("ada"), tiny.scores("ben")[TALKER]) == ({TALKER: 6, LISTENER: 10}, 5)
    assert [notes.read_text().splitlines().count(said) for said in ("crowded 6", "5")] == [2, 1]


def test_a_killed_batch_does_not_wait_for_the_notebook_that_is_running(
    tiny: TinyClass, with_fake_judge: str
) -> None:
    tiny.submit("ada", "__import__('time').sleep(3600)")
    batch = subprocess.Popen([sys.executable, "-W", "ignore", "-c", GRADE, str(tiny.path), with_fake_judge])
    while len(leftovers(tiny)) < 2:  # the worker and the supervisor of its boxes
        assert batch.poll() is None
        time.sleep(0.05)  # to look at every process of the machine keeps a core busy
    orphans = psutil.Process(batch.pid).children(recursive=True)
    batch.kill()
    batch.wait()
    _, alive = psutil.wait_procs(orphans, timeout=180)
    assert alive == []


def test_the_worker_says_why_it_could_not_begin(tiny: TinyClass, monkeypatch: pytest.MonkeyPatch) -> None:
    tiny.submit("ada")
    report = tiny.grade(judge="no_such_module:Judge", jobs=1)
    assert "no_such_module" in report.rows[0].reason
    assert report.rows[0].state == "not_checked"
    assert tiny.scores("ada") == {TALKER: 0, LISTENER: 0}
    assert Path(tiny.path / "grades.csv").exists()


def test_fork_servers_that_die_are_started_anew(tiny: TinyClass, with_fake_judge: str) -> None:
    tiny.submit("ada", "__import__('time').sleep(1) or 10", 9)
    batch = subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", GRADE, str(tiny.path), with_fake_judge], stderr=subprocess.PIPE
    )
    while len(leftovers(tiny)) < 2:
        assert batch.poll() is None
        time.sleep(0.05)  # to look at every process of the machine keeps a core busy
    for process in psutil.Process(batch.pid).children():
        with contextlib.suppress(psutil.NoSuchProcess):  # it may end meanwhile
            if "autograder.boxes.fork_server" in process.cmdline():
                process.kill()
    _, said = batch.communicate(timeout=180)
    assert batch.returncode == 0, said.decode()
    assert tiny.scores("ada") == {TALKER: 10, LISTENER: 9}


@pytest.mark.parametrize("when", ["canceled meanwhile", "stopped meanwhile", "stopped before"])
def test_an_order_that_is_ended_before_it_has_boxes_ends_as_soon_as_it_has_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, when: str
) -> None:
    executor = order_executor.Executor(tmp_path)
    monkeypatch.setattr(order_executor, "LAST_SECONDS", 0.0)
    monkeypatch.setattr(executor, "fork_servers", Mock())
    boxes = [Mock(), Mock()]
    ends = {"canceled meanwhile": lambda: executor.cancel("1"), "stopped meanwhile": executor.stop}

    def execute(*arguments: Any) -> Execution:
        ends.pop(when, lambda: None)()
        arguments[-1](boxes[0])
        return Execution(())

    monkeypatch.setattr(order_executor, "execute", execute)
    if when == "stopped before":
        executor.stop()
    task = msgspec.json.encode(Task("ada", "lab", "lab", (), "0", "1"))
    order = msgspec.json.encode(Order(msgspec.Raw(task), "a:B"))
    executor.execute("1", order)
    boxes[0].abandon.assert_called_once_with()
    boxes.pop(0)
    executor.execute("1", order)
    assert boxes[0].abandon.called == when.startswith("stopped"), "a cancel ends one order"


EXECUTOR = cases(__file__, "EXECUTOR")


@contextlib.contextmanager
def at_work(
    program: str, place: Path, *, joins: bool = True
) -> Iterator[tuple[Lines, subprocess.Popen[bytes]]]:
    """An executor of its own in the middle of an order."""
    grader, its_own = socket.socketpair()
    with its_own:
        command = [sys.executable, "-c", program, str(place)]
        executor = subprocess.Popen(command, stdin=its_own.fileno(), stdout=subprocess.PIPE)
    lines = Lines(grader)
    try:
        if joins:
            assert isinstance(msgspec.json.decode(lines.hear_json(60.0), type=News), Joined)
        task = msgspec.json.encode(Task("ada", "lab", "lab", (), "0", "1"))
        order = msgspec.json.encode(Order(msgspec.Raw(task), "a:B"))
        lines.say_json(msgspec.json.encode(Give(1, ADDRESS, order)))
        assert executor.stdout
        assert executor.stdout.readline() == b"at work\n"
        yield lines, executor
        assert executor.wait(60.0) == 0
    finally:
        executor.kill()
        executor.wait()


def test_an_executor_that_waits_for_what_never_comes_ends_with_its_batch(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with at_work(EXECUTOR, tmp_path / "pipe", joins=False) as (lines, _):
        lines.close()


DROPPED = cases(__file__, "DROPPED")


@pytest.mark.parametrize("dropped", [True, False])
def test_an_order_ends_when_it_is_dropped_and_when_the_grader_is_gone(tmp_path: Path, dropped: bool) -> None:
    with at_work(DROPPED, tmp_path) as (lines, executor):
        if dropped:
            lines.say_json(msgspec.json.encode(Drop(1)))
            news = msgspec.json.decode(lines.hear_json(60.0), type=News)
            assert isinstance(news, Answered)
            assert b"the boxes are gone" in news.data
        lines.close()
        assert executor.stdout
        assert executor.stdout.readline() == b"abandoned\n"
