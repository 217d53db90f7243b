"""Each limit is met once, has its own word, and costs nobody else anything."""

from __future__ import annotations

import contextlib
import os
import resource
import socket
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder.boxes import cgroups, limit_guards
from autograder.boxes.fork_server import ForkServers
from autograder.boxes.run_limits import Ended, Limits
from autograder.boxes.sandbox import why_impossible
from autograder.execution.executed_cells import Cell, CellCheck, Execution
from autograder.execution.notebook_processes import BoxedProcesses, NotebookSetting, UnboxedProcesses
from autograder.execution.notebook_runner import run_notebook
from autograder.judge import controlled_judge
from autograder.safe_files import scratch_folder
from tests.boxes.fork_servers import SilentJudge
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.boxes.fork_server import Addresses

CHECK = Cell(
    "print('alive')", check=CellCheck("lab.one", "One", points=10, worth=10, limit=2), name="lab-one"
)

Run = Callable[..., Execution]


@pytest.fixture(params=["cgroups", "watched"])
def run(request: pytest.FixtureRequest, tmp_path: Path, boxed: Addresses) -> Iterator[Run]:
    """Runs a cell and then a check under limits; the second time as on a host without cgroups."""
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "watched":
            patch.setattr(limit_guards, "usable", dict)
            patch.setattr(
                limit_guards, "Group", lambda memory, processes: cgroups.Group(memory, processes, {})
            )
        elif len(cgroups.usable()) < 2:
            pytest.skip("this host lets us make no cgroups")

        def go(source: str, **changed: float) -> Execution:
            limits = Limits(**{"cell_seconds": 30.0, "interrupt_grace": 1.0, **changed})  # type: ignore[arg-type]
            with (
                scratch_folder(tmp_path) as folder,
                BoxedProcesses(boxed, NotebookSetting(folder, limits)) as place,
            ):
                execution = run_notebook(
                    [Cell(source), CHECK],
                    judge=contextlib.nullcontext(SilentJudge()),
                    processes=place,
                )
                return replace(execution, cpu_seconds=place.guard.cpu_seconds)

        yield go


def key(execution: Execution) -> str:
    diagnosis = execution.verdicts[1].diagnosis
    assert diagnosis is not None
    return diagnosis.key


def test_memory(run: Run) -> None:
    execution = run("hoard = [bytearray(10_000_000) for _ in range(200)]", memory_bytes=500_000_000)
    assert execution.cells[0].ended is Ended.OUT_OF_MEMORY
    assert key(execution) == "out_of_memory"
    assert "memory" in execution.verdicts[1].diagnosis.text  # type: ignore[union-attr]
    assert execution.trouble == ""


def test_memory_that_was_given_back_before_anyone_looked(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """A watch comes by now and then: what a process may have must not depend on when."""
    monkeypatch.setattr(limit_guards, "INTERVAL", 3600.0)
    source = "try:\n    bytearray(700_000_000)\nexcept MemoryError:\n    pass"
    execution = run(source, memory_bytes=500_000_000)
    assert execution.cells[0].ended is Ended.OUT_OF_MEMORY
    assert key(execution) == "out_of_memory"


def test_memory_that_a_process_hides_by_its_name(tmp_path: Path) -> None:
    for name in ("1 kB", "a b kB", "RssAnon: 1 kB"):
        tmp_path.joinpath("status").write_text(
            f"Name:\t{name}\nVmHWM:\t  9000 kB\nRssAnon:\t  2000 kB\nRssFile:\t  1000 kB\nRssShmem:\t     0 kB\n"
        )
        assert limit_guards._memory_of(str(tmp_path)) == (2000 * 1024, 8000 * 1024)


def test_tables_of_pages_are_memory(tmp_path: Path) -> None:
    # Whoever reads what nobody has written has no page of it, and two bytes of a table for each thousand.
    tmp_path.joinpath("status").write_text("VmHWM:\t  10 kB\nVmPTE:\t  3000000 kB\nRssAnon:\t  8 kB\n")
    tmp_path.joinpath("smaps_rollup").write_text("Pss_Anon:\t  8 kB\nPss_Shmem:\t  0 kB\n")
    for measure in (limit_guards._memory_of, limit_guards._exact_memory_of):
        assert measure(str(tmp_path)) == (3_000_008 * 1024,) * 2


def test_memory_in_sockets_belongs_to_no_process(run: Run) -> None:
    fill = cases(__file__, "memory_in_sockets_belongs_to_no_process")
    execution = run(fill, socket_bytes=20_000_000)
    assert (execution.cells[0].ended, key(execution)) == (Ended.OUT_OF_MEMORY, "out_of_memory")


def test_locks_of_files_are_memory_that_no_cgroup_counts(run: Run) -> None:
    lock = cases(__file__, "locks_of_files_are_memory_that_no_cgroup_counts")
    execution = run(lock.format(4), file_locks=300)
    assert (execution.cells[0].ended, key(execution)) == (Ended.TOO_MANY_LOCKS, "too_many_locks")
    assert "locked more parts of files" in execution.verdicts[1].diagnosis.text  # type: ignore[union-attr]
    # Two of the watch's looks fall into half a second.
    assert run(lock.format(0.5), file_locks=500).cells[0].ended is Ended.DONE


def test_connections_that_nobody_accepts_have_no_descriptor(run: Run) -> None:
    connect = cases(__file__, "connections_that_nobody_accepts_have_no_descriptor")
    execution = run(connect, all_open_files=500)
    assert (execution.cells[0].ended, key(execution)) == (Ended.TOO_MANY_FILES, "too_many_files")


def test_memory_that_many_processes_take_together(run: Run) -> None:
    fork = cases(__file__, "memory_that_many_processes_take_together")
    execution = run(fork, memory_bytes=500_000_000)
    assert key(execution) in ("out_of_memory", "not_asked")
    # With cgroups the system ends one of the five, which need not be the kernel.
    assert execution.cells[0].ended in (Ended.OUT_OF_MEMORY, Ended.DONE)


def test_processes(run: Run, request: pytest.FixtureRequest) -> None:
    # For root without cgroups nothing but the watch is there, and a real bomb may be faster than it.
    slowly = "time.sleep(0.02)" if "watched" in request.node.name and os.geteuid() == 0 else "pass"
    bomb = cases(__file__, "processes").replace("SLOWLY", slowly)
    execution = run(bomb, processes=60, cell_seconds=60.0)
    assert execution.cells[0].ended in (Ended.TOO_MANY_PROCESSES, Ended.DONE)
    assert key(execution) in ("too_many_processes", "not_asked")


def test_a_bomb_that_was_faster_than_the_watch_is_no_matter_of_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a crowded machine a look comes late: then its processes have more files open than a box may, too."""
    limits = Limits()
    use = limit_guards.Use(limits.processes + 1, 0, 0, 0.0, limits.all_open_files + 1)
    monkeypatch.setattr(limit_guards, "usable", dict)
    monkeypatch.setattr(limit_guards, "use_of", lambda *_: use)
    guard = limit_guards.BoxGuard(limits)
    guard.watch(os.getpid())
    assert guard.exceeded() is Ended.TOO_MANY_PROCESSES
    guard.close()


@pytest.mark.parametrize(
    ("hoard", "ended"),
    [
        ("bytearray(os.urandom(1000) * 300_000)", Ended.OUT_OF_MEMORY),
        ("[os.eventfd(0) for _ in range(190)]", Ended.TOO_MANY_FILES),
    ],
)
def test_what_a_process_holds_whose_first_thread_has_ended(run: Run, hoard: str, ended: Ended) -> None:
    """Linux shows such a process as a zombie without memory and files (proc_pid_task(5))."""
    hides = cases(__file__, "what_a_process_holds_whose_first_thread_has_ended").replace("HOARD", hoard)
    execution = run(hides, memory_bytes=600_000_000, all_open_files=500)
    assert execution.cells[0].ended is ended


@pytest.mark.parametrize("beside", [True, False])
@pytest.mark.parametrize("used_up", ["watches", "pipes"])
def test_who_runs_while_the_counters_of_the_user_are_used_up_runs_again_alone(
    monkeypatch: pytest.MonkeyPatch, used_up: str, beside: bool
) -> None:
    """Whichever submission used them up: each box that runs at that time ends for memory, and runs again alone."""
    room = {"watches": True, "pipes": True}
    monkeypatch.setattr(limit_guards, "usable", dict)
    monkeypatch.setattr(limit_guards, "use_of", lambda *_: limit_guards.Use(0, 0, 0, 0.0, 0))
    monkeypatch.setattr(limit_guards, "INTERVAL", 0.0)
    monkeypatch.setattr(limit_guards, "_can_watch", lambda: room["watches"])
    monkeypatch.setattr(limit_guards, "_can_make_large_pipes", lambda: room["pipes"])
    monkeypatch.setattr(limit_guards, "_used_up_at", 0.0)
    guards = [limit_guards.BoxGuard(Limits(beside=beside)) for _ in range(2)]
    for guard in guards:
        guard.watch(os.getpid())
        assert guard.exceeded() is None
    room[used_up] = False
    ended = Ended.OUT_OF_MEMORY if beside or used_up == "watches" else None
    assert guards[0].exceeded() is ended
    room[used_up] = True  # the box has ended, before the other one was looked at
    assert guards[1].exceeded() is ended
    room[used_up] = False  # somebody else's doing, since before this one began
    late = limit_guards.BoxGuard(Limits(beside=beside))
    late.watch(os.getpid())
    assert late.exceeded() is None
    for guard in (*guards, late):
        guard.close()


def test_a_user_whose_counters_have_room_is_found_to_have_room() -> None:
    assert limit_guards._can_watch()
    assert limit_guards._can_make_large_pipes()


@pytest.mark.parametrize("kind", ["RLIMIT_NOFILE", "RLIMIT_SIGPENDING"])
def test_of_what_linux_counts_for_a_user_a_box_gets_less_than_the_grader(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limit_guards, "usable", dict)
    guard = limit_guards.BoxGuard(Limits())
    own = resource.getrlimit(getattr(resource, kind))[0]
    assert guard.rlimits[kind] < (sys.maxsize if own == resource.RLIM_INFINITY else own)
    guard.close()


def test_threads_that_the_system_refuses(run: Run) -> None:
    threads = cases(__file__, "threads_that_the_system_refuses")
    execution = run(threads + '\ntime.sleep(3)\nraise RuntimeError("can\'t start new thread")', processes=60)
    assert execution.cells[0].ended in (Ended.TOO_MANY_PROCESSES, Ended.RAISED)


def test_processor_time(run: Run) -> None:
    execution = run("while True:\n    pass", cpu_seconds=1.0)
    assert execution.cells[0].ended is Ended.OUT_OF_CPU
    assert key(execution) == "out_of_cpu"
    assert execution.cpu_seconds > 1.0


def test_disk(run: Run) -> None:
    execution = run("open('big', 'wb').write(bytes(60_000_000))\ncheck = 1", scratch_bytes=50_000_000)
    assert execution.cells[0].ended is Ended.RAISED
    assert execution.cells[0].error.startswith(("OSError: [Errno 28]", "OSError: [Errno 27]"))
    assert execution.cells[1].ended is Ended.DONE


def test_number_of_files(run: Run) -> None:
    many = "for n in range(1000):\n    open(f'file{n}', 'w').close()"
    execution = run(many, scratch_files=300)
    assert execution.cells[0].error.startswith("OSError: [Errno 28]")


def test_open_files(run: Run) -> None:
    execution = run("held = [open('/dev/null') for _ in range(2000)]", open_files=200)
    assert execution.cells[0].error.startswith("OSError: [Errno 24]")


def test_output(run: Run) -> None:
    execution = run("while True:\n    print('x' * 10_000)", flood_bytes=2_000_000)
    assert execution.cells[0].ended is Ended.TOO_MUCH_OUTPUT
    assert len(str(execution.cells[0].outputs)) < 300_000
    # So busy a loop mostly does not obey an interrupt in time, and its kernel is ended.
    assert key(execution) == ("not_asked" if execution.cells[1].ended is Ended.DONE else "too_much_output")


def test_a_line_of_100_megabytes(run: Run) -> None:
    execution = run("print('x' * 100_000_000)")
    assert execution.cells[0].ended in (Ended.DONE, Ended.TOO_MUCH_OUTPUT)
    assert len(str(execution.cells[0].outputs)) < 300_000
    assert "alive" in str(execution.cells[1].outputs)


def test_an_interrupt_that_meets_the_kernel_itself_leaves_it_alive(run: Run) -> None:
    """It is stopped behind the cell's code, where its output is flushed: then no answer to the cell ever comes."""
    hangs_once = cases(__file__, "an_interrupt_that_meets_the_kernel_itself_leaves_it_alive")
    execution = run(hangs_once, cell_seconds=2.0)
    assert execution.cells[0].ended is Ended.TIMED_OUT
    assert "alive" in str(execution.cells[1].outputs)


def test_an_error_of_a_limit_has_its_own_word() -> None:
    from autograder.execution.executed_cells import CellRun
    from autograder.execution.verdicts_without_judge import without_verdict

    assert CHECK.check is not None
    full = CellRun(Ended.RAISED, error="OSError: [Errno 28] No space left on device: 'log'")
    verdict = without_verdict(CHECK.check, CellRun(Ended.RAISED), [("log(x)", full)], 10)
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.key == "disk_full"
    assert "space" in verdict.diagnosis.text


def test_many_small_processes_cannot_take_the_watcher_with_them(run: Run) -> None:
    many = cases(__file__, "many_small_processes_cannot_take_the_watcher_with_them")
    execution = run(many, memory_bytes=400_000_000)
    # Whoever is ended, it is one of the box, and the submission's own doing.
    assert execution.trouble == ""


@pytest.mark.ros
@pytest.mark.parametrize("kind", [BoxedProcesses, UnboxedProcesses])
def test_a_judge_has_a_limit_of_memory(kind: type[BoxedProcesses | UnboxedProcesses], tmp_path: Path) -> None:
    boxed = kind is BoxedProcesses
    if boxed and why_impossible():
        pytest.skip("no sandbox is possible here")
    limits = Limits()
    own, its_own = socket.socketpair()
    with (
        own, its_own, socket.socket(socket.AF_UNIX) as listener, scratch_folder(tmp_path) as folder,
        ForkServers(controlled_judge.__name__, boxed=boxed) as warm,
        kind(
            warm.addresses,
            NotebookSetting(folder, limits, judges_variables=controlled_judge.environment(boxed=boxed)),
        ) as place,
    ):  # fmt: skip
        listener.bind(str(place.judge_socket))
        listener.listen()
        judge = place.start_judge(listener.fileno(), its_own.fileno())
        assert own.recv(6) == b"ready\n"
        assert resource.prlimit(judge.pid, resource.RLIMIT_DATA) == (limits.judge_bytes, limits.judge_bytes)


def test_what_is_not_in_its_box_yet_is_not_taken_for_all_that_the_host_does() -> None:
    assert limit_guards.use_of(os.getpid(), None) == limit_guards.Use(0, 0, 0, 0.0, 0)
