"""However a box ends, and whoever is killed, no process of it lives on."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil
import pytest

from autograder.boxes import fork_server
from autograder.boxes.boxed_processes import ForkedProcess
from autograder.boxes.fork_server import BESIDE, INSIDE, SUPERVISOR_MODULE, ForkServer, ForkServers
from autograder.boxes.process_isolation import Entrance
from autograder.boxes.run_limits import open_files_of_a_box
from autograder.boxes.sandbox import Enclosure
from autograder.boxes.visible_host import WORK, box_environment
from tests.boxes.fork_servers import NO_JUDGE
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from autograder.boxes.box_connection import Box
    from autograder.boxes.fork_server import Addresses

SECONDS = f"7654.{os.getpid()}"
"""How long the sleepers of this run sleep: another run of the tests beside it has sleepers, too."""
STUBBORN = (
    f"trap '' INT TERM HUP; (setsid sh -c \"trap '' INT TERM HUP; sleep {SECONDS}\" &); sleep {SECONDS}"
)
WORKER = cases(__file__, "WORKER")


def sleepers() -> list[psutil.Process]:
    """What the stubborn program has started."""
    return [p for p in psutil.process_iter(["cmdline"]) if p.info["cmdline"] == ["sleep", SECONDS]]


def gone(within: float = 120.0) -> bool:
    """Whether all sleepers end, which the kernel brings about by itself a moment after the cause."""
    _, alive = psutil.wait_procs(sleepers(), timeout=within)
    return not alive and not sleepers()


def await_sleepers() -> None:
    while len(sleepers()) < 2:
        time.sleep(0.01)


@pytest.fixture
def supervisors(boxed: Addresses, tmp_path: Path) -> Iterator[ForkServer]:
    process = ForkServer(BESIDE, SUPERVISOR_MODULE, tmp_path / "supervisors")
    yield process
    process.stop()


def test_closing_ends_all(supervisors: ForkServer, tmp_path: Path) -> None:
    with Enclosure(supervisors.address, tmp_path / "box") as enclosure:
        enclosure.start(["sh", "-c", STUBBORN])
        await_sleepers()
    assert gone()


def kill_worker(supervisors: ForkServer, worker: subprocess.Popen[bytes]) -> None:
    worker.kill()


def kill_supervisor(supervisors: ForkServer, worker: subprocess.Popen[bytes]) -> None:
    for child in psutil.Process(supervisors._process.pid).children():
        child.kill()


def kill_fork_server(supervisors: ForkServer, worker: subprocess.Popen[bytes]) -> None:
    os.kill(supervisors._process.pid, signal.SIGKILL)


@pytest.mark.parametrize("kill", [kill_worker, kill_supervisor, kill_fork_server])
def test_killing_anyone_ends_all(
    supervisors: ForkServer, tmp_path: Path, kill: Callable[[ForkServer, subprocess.Popen[bytes]], None]
) -> None:
    worker = subprocess.Popen(
        [sys.executable, "-c", WORKER, supervisors.address, str(tmp_path / "box"), STUBBORN],
        stdout=subprocess.PIPE,
    )
    try:
        assert worker.stdout is not None
        assert worker.stdout.readline() == b"up\n"
        await_sleepers()
        kill(supervisors, worker)
        assert gone()
    finally:
        worker.kill()
        worker.communicate()
    assert str(tmp_path) not in Path("/proc/self/mountinfo").read_text()


SLEEPING = {"PYTHONPATH": str(Path(__file__).resolve().parents[2]), "SLEEPERS_SECONDS": SECONDS}


@pytest.fixture
def entered(supervisors: ForkServer, tmp_path: Path) -> Iterator[tuple[Box, ForkedProcess]]:
    """A box, and a process of another fork server that has entered it."""
    warm = ForkServer(INSIDE, "tests.boxes.sleeping_module", tmp_path / "warm", extra=SLEEPING)
    with Enclosure(supervisors.address, tmp_path / "box") as enclosure:
        box = enclosure.box("student")
        entrance = Entrance(cwd=str(WORK), environment=box_environment(), boxed=True)
        yield box, ForkedProcess(warm.address, entrance, [], box)
    warm.stop()


def test_a_process_that_entered_ends_with_its_box(entered: tuple[Box, ForkedProcess]) -> None:
    box, process = entered
    await_sleepers()
    assert process.alive
    box.end()
    assert process.wait(10.0)
    assert not process.lost
    process.end()
    assert gone()


def test_a_process_whose_grader_hangs_up_is_killed(entered: tuple[Box, ForkedProcess]) -> None:
    _, process = entered
    inside = psutil.Process(process.pid)
    process._channel.close()
    psutil.wait_procs([inside], timeout=180)
    assert not inside.is_running()


def test_who_sends_descriptors_to_a_server_may_have_more_in_transit_than_a_box(tmp_path: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(soft, 1024), hard))
    try:
        ForkServer(BESIDE, SUPERVISOR_MODULE, tmp_path / "supervisors").stop()
        now = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
        assert now > 1024
        assert open_files_of_a_box(10**9) <= now / 2
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_fork_servers_of_which_one_cannot_start_leave_no_process_and_no_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def none_left(mode: str, *words: Any) -> ForkServer:
        if mode == BESIDE:
            raise OSError("no process left")
        return ForkServer(mode, *words)

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(fork_server, "ForkServer", none_left)
    before = psutil.Process().children()
    # The error is kept, because with it everything would go that was not stopped.
    with pytest.raises(OSError, match="no process left") as kept:
        ForkServers(NO_JUDGE, boxed=True)
    assert psutil.Process().children() == before
    assert not list(tmp_path.iterdir())
    del kept


def test_the_fork_server_of_programs_starts_when_it_is_first_needed() -> None:
    with ForkServers(NO_JUDGE, boxed=True) as servers:
        assert not servers.addresses.programs
        before = len(psutil.Process().children())
        address = servers.with_programs().programs
        assert Path(address).is_socket()
        assert servers.with_programs().programs == address
        assert len(psutil.Process().children()) == before + 1
    assert not Path(address).exists()


def test_without_boxes_no_fork_server_of_programs_starts() -> None:
    with ForkServers(NO_JUDGE, boxed=False) as servers:
        assert not servers.with_programs().programs
