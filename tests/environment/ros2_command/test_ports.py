"""Who takes part on this machine, read from the operating system's tables."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from course_runtime.ros2_command import ports
from course_runtime.ros2_command.ports import Ports, domain_id, ports_in_use

if TYPE_CHECKING:
    from pathlib import Path

HEAD = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n"


def line(port: int, inode: int, address: str = "00000000") -> str:
    return f"  1: {address}:{port:04X} 00000000:0000 07 0:0 00:0 0 1000 0 {inode} 2 0 0\n"


@pytest.fixture
def tables(tmp_path: Path) -> list[str]:
    """Domain 42 begins at 17900; its participants take 17910, 17912, …; 17911 is the first one's other port.

    Who holds 17972 listens on 127.0.0.1 only, as no participant does.
    """
    table = tmp_path / "udp"
    held = (17910, 17911, 17912, 17914, 7410, 18160)
    listener = line(17972, 2000, "0100007F")
    table.write_text(HEAD + "".join(line(port, 1000 + at) for at, port in enumerate(held)) + listener)
    return [str(table), str(tmp_path / "missing")]


@pytest.fixture
def processes(tmp_path: Path) -> Path:
    """Process 7 is this one, 8 runs, 9 was stopped with Ctrl-Z."""
    for number, state, inodes in ((7, "R", (1000, 1001)), (8, "S", (1002,)), (9, "T", (1003,))):
        (tmp_path / str(number) / "fd").mkdir(parents=True)
        (tmp_path / str(number) / "stat").write_text(f"{number} (py) thon) {state} 1 1 1")
        for at, inode in enumerate(inodes):
            (tmp_path / str(number) / "fd" / str(at)).symlink_to(f"socket:[{inode}]")
    (tmp_path / "self").symlink_to("7")
    return tmp_path


def test_own_ports_and_those_of_others_that_run(tables: list[str], processes: Path) -> None:
    assert ports_in_use(42, tables, processes) == Ports(frozenset({17910}), frozenset({17912}))


def test_a_process_that_ends_meanwhile_is_passed_over(
    tables: list[str], processes: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Linux says of its files that there is no such process, and not that there is no such file."""
    stat = os.stat

    def gone(path: Any, **more: Any) -> os.stat_result:
        if str(path).endswith("8/stat"):
            raise ProcessLookupError(errno.ESRCH, "No such process")
        return stat(path, **more)

    monkeypatch.setattr(os, "stat", gone)
    assert ports_in_use(42, tables, processes) == Ports(frozenset({17910}), frozenset({17912}))


def test_each_domain_has_its_own(tables: list[str], processes: Path) -> None:
    assert ports_in_use(0, tables, processes) == Ports(frozenset(), frozenset({7410}))
    assert ports_in_use(43, tables, processes) == Ports(frozenset(), frozenset({18160}))
    assert ports_in_use(1, tables, processes) == Ports(frozenset(), frozenset())


def test_without_tables_nobody_knows(tmp_path: Path) -> None:
    assert ports_in_use(42, [str(tmp_path / "missing")]) is None


def test_a_process_that_is_stopped_is_not_counted(other_domain: str) -> None:
    port = 7400 + 250 * int(other_domain) + 10
    program = f"import socket; s = socket.socket(2, 2); s.bind(('', {port})); print(flush=True); input()"
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout
        holder.stdout.readline()
        assert ports_in_use(int(other_domain)) == Ports(frozenset(), frozenset({port}))
        holder.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, holder.pid, os.WSTOPPED)
        assert ports_in_use(int(other_domain)) == Ports(frozenset(), frozenset())
        holder.kill()


@pytest.mark.parametrize("text", ["abc", "-1", "300", "1.5"])
def test_a_wrong_domain_is_named(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    with pytest.raises(RuntimeError, match="ROS_DOMAIN_ID is"):
        domain_id()


def test_only_this_machine_is_asked_where_the_user_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    assert not ports.only_this_machine()
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    assert ports.only_this_machine()
