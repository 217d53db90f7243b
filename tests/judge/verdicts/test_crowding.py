"""When the machine is called too busy: by the threads that want a processor during the look itself."""

from __future__ import annotations

from itertools import chain, cycle, repeat
from typing import TYPE_CHECKING

import pytest

from autograder.judge import machine_fitness
from autograder.judge.machine_fitness import ANSWER_WITHIN, Crowding, Hurry, OutOfTime

if TYPE_CHECKING:
    from collections.abc import Iterable


@pytest.mark.parametrize(
    ("counts", "too_busy"),
    [
        pytest.param(repeat(24), True, id="twelve for each processor"),
        pytest.param(repeat(20), False, id="ten"),
        pytest.param(cycle([0, 0, 0, 40]), False, id="many, but for moments"),
        pytest.param(chain([0], repeat(40)), True, id="many from the first moment on"),
        pytest.param(repeat(0), False, id="the machine does not tell"),
    ],
)
def test_the_average_of_the_look_decides(
    monkeypatch: pytest.MonkeyPatch, counts: Iterable[int], too_busy: bool
) -> None:
    monkeypatch.setattr(machine_fitness, "_COUNT_EVERY", 0.0)
    waiting, taken = iter(counts), []

    def runnable() -> int:
        taken.append(next(waiting))
        return taken[-1]

    with Crowding(runnable, processors=2) as counted:
        while len(taken) < 40:  # the thread counts on by itself
            pass
    assert counted.too_busy is too_busy


def test_a_look_that_ends_at_once_is_counted_once() -> None:
    with Crowding(lambda: 24, processors=2) as counted:
        pass
    assert counted.too_busy


@pytest.mark.parametrize(
    ("seconds", "runnable", "ends"),
    [
        pytest.param(ANSWER_WITHIN + 1, 16, True, id="long, and eight for each processor"),
        pytest.param(ANSWER_WITHIN + 1, 8, False, id="long, and four"),
        pytest.param(ANSWER_WITHIN - 1, 40, False, id="not long yet"),
    ],
)
def test_a_long_check_ends_on_a_busy_machine_only(seconds: float, runnable: int, ends: bool) -> None:
    times = iter([0.0, 0.0, 0.2, seconds, seconds, seconds])
    hurry = Hurry(lambda: runnable, 2, lambda: next(times))
    hurry()
    if ends:
        with pytest.raises(OutOfTime):
            hurry()
    hurry()  # what clears up afterwards is left alone


def test_the_time_of_a_build_does_not_count() -> None:
    times = iter([0.0, 0.0, 100.0, 101.0, 101.0 + ANSWER_WITHIN])
    building = iter([True, False, False])
    hurry = Hurry(lambda: 16, 2, lambda: next(times), lambda: next(building))
    hurry()
    hurry()
    with pytest.raises(OutOfTime):
        hurry()
