"""CPU seconds by role: which process has which role, and what the table says."""

from __future__ import annotations

import subprocess

import pytest

from benchmarks.cpu_by_role import ROLES, Accounts, role_of, table
from benchmarks.machine import CpuGroup
from course_runtime.python_child import python_child
from tests.cases import cases

SERVER = "python -P -m autograder.boxes.fork_server"


@pytest.mark.parametrize(
    ("words", "folder", "now", "role"),
    cases(__file__, "a_process_has_the_role_of_its_command_line_or_of_its_parent"),
)
def test_a_process_has_the_role_of_its_command_line_or_of_its_parent(
    words: str, folder: str, now: str, role: str
) -> None:
    assert role_of(words, folder, now) == role


def test_the_table_compares_medians_and_adds_up_each_run() -> None:
    def runs(*seconds: float) -> list[dict[str, float]]:
        return [dict.fromkeys(ROLES, one) for one in seconds]

    lines = table(runs(1, 2, 9), runs(1, 1, 7)).splitlines()
    assert lines[-1] == f"| all: median of the runs | {2 * len(ROLES):.3f} | {len(ROLES):.3f} | 0.50 |"
    assert "| judges | 0.000 | 1.000 | – |" in table([], runs(1))


def test_what_a_process_spends_is_counted_with_what_it_starts() -> None:
    busy = python_child("-c", "import subprocess; subprocess.run(['sh', '-c', 'exec seq 300000'])").command
    group = CpuGroup.make()
    if group is None:
        pytest.skip("this system makes no control groups that count CPU time")
    group.remove()
    with Accounts() as accounts:
        subprocess.run(busy, stdout=subprocess.DEVNULL, preexec_fn=accounts.prepare, check=True)
    assert accounts.seconds["grader"] > 0
    assert accounts.seconds["judges"] == 0
