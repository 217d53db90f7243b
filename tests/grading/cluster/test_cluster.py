"""A class graded by real workers of a real Dask cluster on loopback, with a judge that needs no ROS; once with all."""

from __future__ import annotations

import contextlib
import io
import signal
import subprocess
import sys
import threading
from typing import TYPE_CHECKING, Any

import psutil
import pytest
from dask_cluster import UNBOXED, VERSION, DaskCluster, end, until
from rich.console import Console
from tiny_class import LISTENER, STANDS_STILL, TALKER, TinyClass

from autograder import course
from autograder.boxes.sandbox import why_impossible
from autograder.grading.batch import grade
from autograder.grading.classes import class_directory
from autograder.grading.classes.class_directory import ClassDirectory, switch_sandbox_off
from autograder.grading.cluster import cluster_dispatcher
from autograder.grading.grading_errors import GradingError
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from autograder.grading.reporting.grade_report import GradeReport

pytest.importorskip("distributed", reason="./course setup --with cluster installs it")


@pytest.fixture(scope="module")
def cluster() -> Iterator[DaskCluster]:
    with DaskCluster() as running:
        yield running


@pytest.fixture(autouse=True)
def _unboxed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Boxes have tests of their own; here what a notebook does to the machine shows where it ran."""
    monkeypatch.setattr(cluster_dispatcher, "course_version", lambda: VERSION)


@pytest.fixture
def unboxed(tiny: TinyClass) -> TinyClass:
    switch_sandbox_off(tiny.path)
    return tiny


class Said(io.StringIO):
    """What a batch says."""

    def console(self) -> Console:
        return Console(file=self, width=400)


def graded_on(cluster: DaskCluster, tiny: TinyClass, said: Said | None = None) -> GradeReport:
    console = (said or Said()).console()
    return tiny.grade(scheduler=cluster.address, judge="fake_judge:FakeJudge", console=console)


def hold(folder: Path) -> str:
    """An answer that says where it runs and never comes, the first time; later it is 7."""
    return (
        'exec("import os, pathlib, time\\n'
        f"place = pathlib.Path({str(folder)!r}) / 'pid'\\n"
        "first = not place.exists()\\n"
        "first and place.write_text(str(os.getpid()))\\n"
        'while first: time.sleep(0.01)") or 7'
    )


def has_ended(process: psutil.Process) -> bool:
    with contextlib.suppress(psutil.NoSuchProcess):
        return process.status() == psutil.STATUS_ZOMBIE
    return True


def descendants(process: subprocess.Popen[str]) -> set[int]:
    return {child.pid for child in psutil.Process(process.pid).children(recursive=True)}


def test_a_worker_that_is_killed_costs_only_its_tasks_again_and_the_gradebook_is_that_of_a_local_run(
    cluster: DaskCluster, unboxed: TinyClass, tmp_path: Path, with_fake_judge: str
) -> None:
    for number, student in enumerate(("ada", "ben", "cleo", "dora")):
        unboxed.submit(student, number, 10 - number)
    unboxed.submit("eve", hold(tmp_path), 5)
    unboxed.submit("fay", "1/0", 3)
    killed: list[str] = []

    def kill_the_one_that_holds(workers: dict[str, subprocess.Popen[str]]) -> None:
        until((tmp_path / "pid").exists)
        until((tmp_path / "pid").read_text)
        pid = int((tmp_path / "pid").read_text())
        for name, process in workers.items():
            if pid in descendants(process):
                killed.append(name)
                end(process)

    with cluster.worker("one") as one, cluster.worker("two") as two:
        killer = threading.Thread(target=kill_the_one_that_holds, args=({"one": one, "two": two},))
        killer.start()
        report = graded_on(cluster, unboxed)
        killer.join()
    assert len(killed) == 1
    assert (report.executed, report.problems, report.exit_code) == (6, (), 0)
    assert unboxed.scores("eve") == {TALKER: 7, LISTENER: 5}

    there = {row.student: unboxed.scores(row.student) for row in report.rows}
    local = unboxed.grade(judge=with_fake_judge, again=True)
    assert local.executed == 6
    assert {row.student: unboxed.scores(row.student) for row in local.rows} == there
    assert local.rows == report.rows


PICKLER = cases(__file__, "PICKLER")

# Every client of Dask reads what workers warn of. This one is what the grader would be without its client.
STOCK_CLIENT = cases(__file__, "STOCK_CLIENT")

TOO_LARGE = (
    "from autograder.grading.cluster import dask_calls as c; c.execute_order = lambda _: bytes(40_000_000)"
)
NO_BYTES = "from autograder.grading.cluster import dask_calls as c; c.execute_order = lambda _: {'score': 10}"
FORGES = cases(__file__, "FORGES")


def test_workers_that_forge_are_turned_out_by_name_and_run_nothing_here(
    cluster: DaskCluster, unboxed: TinyClass, tmp_path: Path
) -> None:
    there = tmp_path / "there"
    bomb = PICKLER.format(command=f"touch {there}")
    for number, student in enumerate(("ada", "ben", "cleo", "dora", "eve")):
        unboxed.submit(student, number, 10)
    said = Said()
    bad = {"pickler": bomb, "large": TOO_LARGE, "object": NO_BYTES, "forger": FORGES}
    with contextlib.ExitStack() as workers:
        for name, before in bad.items():
            workers.enter_context(cluster.worker(name, before=before))

        def come_when_they_are_turned_out() -> None:
            until(lambda: said.getvalue().count("gets no work") == len(bad))
            workers.enter_context(cluster.worker("honest"))

        rescue = threading.Thread(target=come_when_they_are_turned_out)
        rescue.start()
        report = graded_on(cluster, unboxed, said)
        rescue.join()
        assert not there.exists()
        # The bomb is real: a client as Dask has it would have run it.
        address = next(line for line in said.getvalue().splitlines() if "pickler" in line)
        address = address.partition("(")[2].partition(")")[0]
        subprocess.run(
            [sys.executable, "-c", STOCK_CLIENT, cluster.address, address], check=False, capture_output=True
        )
        until(there.exists)
    assert report.exit_code == 0
    assert [unboxed.scores(student)[TALKER] for student in ("ada", "ben", "cleo", "dora", "eve")] == [
        0,
        1,
        2,
        3,
        4,
    ]
    for name, words in {
        "pickler": "the worker sent an impossible answer",
        "large": "the answer has 400000",
        "object": "the worker sent an impossible answer",
        "forger": "1000 of 10 points",
    }.items():
        line = next(line for line in said.getvalue().splitlines() if f"The worker {name} " in line)
        assert words in line


def test_a_worker_of_another_version_is_refused_by_name_and_the_batch_goes_on(
    cluster: DaskCluster, unboxed: TinyClass, tmp_path: Path
) -> None:
    """The other one is as Dask's own command makes it."""
    unboxed.submit("ada", 4)
    said = Said()
    with cluster.worker("old", version="yesterday"), cluster.plain_worker("plain", tmp_path):
        report = graded_on(cluster, unboxed, said)
    assert report.exit_code == 0
    assert unboxed.scores("ada")[TALKER] == 4
    assert "the worker's version of the course is yesterday, and here it is test" in said.getvalue()
    assert "The worker old (tcp://127.0.0.1:" in said.getvalue()


def test_where_nobody_can_execute_anything_the_class_stays_as_it_is(
    cluster: DaskCluster, tiny: TinyClass, with_fake_judge: str
) -> None:
    switch_sandbox_off(tiny.path)
    tiny.submit("ada", 4)
    tiny.grade(judge=with_fake_judge)
    class_directory._unboxed.clear()
    with (
        cluster.worker("bare"),
        pytest.raises(GradingError, match=rf"bare .*the worker has no sandbox: {UNBOXED}"),
    ):
        graded_on(cluster, tiny)
    with pytest.raises(GradingError, match="has no workers"):
        tiny.grade(scheduler=cluster.address, again=True)
    with pytest.raises(GradingError, match="cannot be reached"):
        tiny.grade(scheduler="tcp://127.0.0.1:1", again=True)
    assert tiny.scores("ada")[TALKER] == 4


GRADE = f"{STANDS_STILL}\n{cases(__file__, 'GRADE')}"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_batch_that_is_stopped_leaves_nothing_running_and_the_next_one_goes_on(
    cluster: DaskCluster, unboxed: TinyClass, tmp_path: Path, number: signal.Signals
) -> None:
    for student in ("ada", "ben"):
        unboxed.submit(student, 4)
    unboxed.submit("cleo", hold(tmp_path))
    with cluster.worker("one") as worker:
        batch = subprocess.Popen(
            [sys.executable, "-W", "ignore", "-c", GRADE, str(unboxed.path), cluster.address],
            stderr=subprocess.DEVNULL,
        )
        until((tmp_path / "pid").exists)
        until((tmp_path / "pid").read_text)
        kernel = psutil.Process(int((tmp_path / "pid").read_text()))
        batch.send_signal(number)
        assert batch.wait(timeout=180) != 0
        until(lambda: has_ended(kernel))
        assert worker.poll() is None
        report = graded_on(cluster, unboxed)
    assert report.exit_code == 0
    assert report.executed == 1
    assert [unboxed.scores(student)[TALKER] for student in ("ada", "ben", "cleo")] == [4, 4, 7]


@pytest.mark.ros
def test_a_lab_is_graded_on_a_worker_as_it_is_here(
    cluster: DaskCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The real judge, in boxes where this machine can make them."""
    from autograder.grading.new_classes.new_class import new_class

    path = tmp_path / "class"
    new_class(path, course.root(), assignments=["lab_1_2"], cell_seconds=30, notebook_seconds=120)
    solved = (path / "source" / "lab_1_2" / "lab_1_2.ipynb").read_text()
    for student, text in {"ada": solved, "ben": (path / "release/lab_1_2/lab_1_2.ipynb").read_text()}.items():
        (path / "submitted" / student / "lab_1_2").mkdir(parents=True)
        (path / "submitted" / student / "lab_1_2" / "lab_1_2.ipynb").write_text(text)
    obstacle = why_impossible()
    if obstacle:
        switch_sandbox_off(path)
    options: dict[str, Any] = {"console": Console(quiet=True), "feedback": False}
    with cluster.worker("one", 2, obstacle=obstacle):
        there = grade(path, scheduler=cluster.address, **options)
    (ClassDirectory(path).state / "class.db").unlink()
    here = grade(path, again=True, jobs=2, **options)
    assert [(row.student, row.exercise, row.score) for row in there.rows] == [
        (row.student, row.exercise, row.score) for row in here.rows
    ]
    assert sum(row.score for row in there.rows if row.student == "ada") > 0
    assert all(row.state == "passed" for row in there.rows if row.student == "ada")
    assert all(row.score == 0 for row in there.rows if row.student == "ben")
    assert there.exit_code == 0
