"""Time limits get longer while the machine is busy; a machine that is too busy, or loses messages, is told."""

from __future__ import annotations

import errno
import os
import select
import socket
from itertools import chain, cycle, repeat
from typing import TYPE_CHECKING

import pytest

from autograder.judge import machine_fitness
from autograder.judge.machine_fitness import (
    ANSWER_WITHIN,
    SLOWEST,
    Crowding,
    Hurry,
    OutOfTime,
    Patience,
    machine_slowness,
    slowness,
)

if TYPE_CHECKING:
    from collections.abc import Iterable


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize(
    ("runnable", "processors", "expected"),
    [(1, 2, 1.0), (8, 2, 1.0), (16, 2, 2.0), (12, 1, SLOWEST), (10_000, 2, SLOWEST), (0, 64, 1.0)],
)
def test_a_crowd_slows_down_and_what_the_limits_bear_does_not(
    runnable: int, processors: int, expected: float
) -> None:
    assert slowness(runnable, processors) == expected


def test_this_machine_says_how_crowded_it_is() -> None:
    assert 1.0 <= machine_slowness() <= SLOWEST


def test_patience_follows_the_machine_from_moment_to_moment() -> None:
    clock, crowd = Clock(), [1.0]
    patience = Patience(10.0, slowness=lambda: crowd[0], now=clock)
    clock.now += 2.0
    assert patience.left == pytest.approx(8.0)
    crowd[0] = 3.0
    clock.now += 3.0
    assert patience.left == pytest.approx(7.0)
    crowd[0] = 1.0
    clock.now += 8.0
    assert patience.left <= 0.0
    patience.restart()
    assert patience.left == pytest.approx(10.0)


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


def test_a_machine_delivers() -> None:
    assert machine_fitness.delivers()


def test_not_where_nothing_more_may_be_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    class Full:
        def __enter__(self) -> Full:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def register(self, *_: object) -> None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(select, "epoll", Full)
    assert not machine_fitness.delivers()


def test_not_where_a_socket_has_room_for_a_few_datagrams_only(monkeypatch: pytest.MonkeyPatch) -> None:
    class Small(socket.socket):
        def bind(self, address: object) -> None:
            self.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            super().bind(address)  # type: ignore[arg-type]

    monkeypatch.setattr(socket, "socket", Small)
    monkeypatch.setattr(machine_fitness, "_ARRIVES_WITHIN", 0.2)
    assert not machine_fitness.delivers()
