"""A program in a session of its own: what it says is read, and nothing of it is left."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from autograder.standard_output import Collected, collect
from autograder.workspaces.own_session import OwnSession
from tests.cases import cases

FOREVER = 1000.0


def shell(script: str) -> OwnSession:
    return OwnSession(["/bin/sh", "-c", script], os.environ)


def is_gone(pid: int) -> bool:
    """Whether a process has ended, be it that nobody has asked for it yet."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):  # the latter where it goes while it is read
        return True


def test_all_that_it_says_is_collected_with_how_it_ended() -> None:
    with shell("echo one; echo two >&2; exit 3") as program:
        assert collect(program, FOREVER, 1000) == Collected(b"one\ntwo\n", cut=False, ended=True)
        assert program.exit_code() == 3


def test_of_much_output_the_beginning_is_kept() -> None:
    with shell("yes | head -n 100000") as program:
        assert collect(program, FOREVER, 5) == Collected(b"y\ny\ny", cut=True, ended=True)


@pytest.mark.parametrize(
    "script",
    [
        pytest.param("echo one; sleep 1000", id="it hangs"),
        pytest.param("echo one; exec >&- 2>&-; sleep 1000", id="it hangs with its output closed"),
    ],
)
def test_one_that_does_not_end_in_time_is_late(script: str) -> None:
    with shell(script) as program:
        said = collect(program, 0.2, 1000)
        assert said.late
        assert b"one\n".startswith(said.output)
        assert program.exit_code() is None
    assert program.exit_code() is not None


def test_one_that_nobody_wants_is_not_waited_for() -> None:
    with shell("sleep 1000") as program:
        assert collect(program, FOREVER, 1000, lambda: True) == Collected(b"", cut=False, ended=False)
        assert program.exit_code() is None


@pytest.mark.parametrize("polite", [0.0, 0.2])
@pytest.mark.parametrize(
    "start",
    [
        pytest.param("sleep 1000 &", id="a child"),
        pytest.param("trap '' INT; (trap '' INT; exec sleep 1000) &", id="a child that ignores an interrupt"),
        pytest.param("setsid sleep 1000 &", id="a child in a session of its own"),
        pytest.param("(sleep 1000 & echo $!) ; true &", id="a child whose parent has ended"),
    ],
)
def test_its_end_is_the_end_of_all_that_it_has_started(start: str, polite: float) -> None:
    with shell(f"{start} echo $!; wait; sleep 1000") as program:
        said = b""
        while not said.endswith(b"\n"):
            said += program.read(FOREVER) or b""
        program.end(polite)
    pids = [int(word) for word in said.split()]
    deadline = time.monotonic() + 60.0
    while not all(map(is_gone, pids)):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_it_may_end_by_itself_after_an_interrupt() -> None:
    with shell("trap 'echo bye; exit 4' INT; echo ready; while :; do sleep 0.05; done") as program:
        assert program.read(FOREVER) == b"ready\n"
        program.end(FOREVER)
        assert program.exit_code() == 4


KILLED = cases(__file__, "KILLED")


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_nothing_outlives_a_parent_that_is_killed(how: signal.Signals) -> None:
    """A child, one in a session of its own whose parent has ended, and the program, which ignores what it can."""
    script = (
        "trap '' INT TERM HUP; sleep 1000 & echo $!; (setsid sleep 1000 & echo $!); echo $$; wait; sleep 1000"
    )
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, script], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as parent:
        assert parent.stdout is not None
        handles = [os.pidfd_open(int(word)) for word in parent.stdout.readline().split()]
        parent.send_signal(how)
    assert len(handles) == 4
    for handle in handles:
        select.select([handle], [], [])  # readable once it has ended; without an end this test has none
        os.close(handle)


def test_what_a_program_leaves_behind_ends_with_it() -> None:
    with shell("setsid sleep 1000 & echo $!; exit 3") as program:
        said = collect(program, FOREVER, 1000)
        assert said.ended
        assert program.exit_code() == 3
        assert is_gone(int(said.output))


def test_how_a_program_ended_is_told_as_it_was() -> None:
    with shell("kill -ABRT $$") as program:
        assert collect(program, FOREVER, 1000) == Collected(b"", cut=False, ended=True)
        assert program.exit_code() == -signal.SIGABRT


def test_a_program_that_is_not_there_is_no_program_that_failed() -> None:
    with pytest.raises(FileNotFoundError):
        OwnSession(["no-such-program"], os.environ)


@pytest.mark.parametrize("name", ["STOP", "KILL"])
def test_one_that_stops_or_kills_its_keeper_is_ended_too(name: str) -> None:
    with shell(f"sleep 1000 & echo $!; kill -{name} $PPID; wait") as program:
        pid = int(program.read(FOREVER) or b"0")
        handle = os.pidfd_open(pid)
        program.end()
        select.select([handle], [], [])
        os.close(handle)
