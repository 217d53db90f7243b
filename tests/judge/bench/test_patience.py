"""A second of patience is longer where the machine is crowded, and never endless."""

from __future__ import annotations

import pytest

from autograder.judge.bench.patience import SLOWEST, Patience, machine_slowness, slowness


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
