"""How many notebooks run at once, decided from looks at the machine that are made up here."""

from __future__ import annotations

import threading

import pytest

from autograder.grading.running.pacing import BOX_BYTES, Gate, Load, Machine, Pace

GIB = 2**30


def steps(
    loads: list[Load], *, cores: int = 2, all_at_work: bool = True, free_bytes: int = 800 * GIB
) -> list[int]:
    pace = Pace(cores, free_bytes)
    allowed = [pace.first]
    for load in loads:
        allowed.append(pace.next(allowed[-1], load, all_at_work=all_at_work))
    return allowed


def test_idle_processors_let_more_in_and_the_more_idle_the_faster() -> None:
    assert steps([Load(0.1, 0.0, 8 * GIB)] * 3) == [4, 5, 6, 7]
    assert steps([Load(0.8, 0.0, 8 * GIB)] * 3) == [4, 6, 8, 10]


def test_nobody_is_added_where_nobody_waits() -> None:
    assert steps([Load(0.9, 0.0, 8 * GIB)] * 3, all_at_work=False) == [4, 4, 4, 4]


def test_there_is_an_end_to_it() -> None:
    assert steps([Load(0.9, 0.0, 800 * GIB)] * 100)[-1] == 24


@pytest.mark.parametrize("stalled", [1.0, None])
def test_processors_that_are_busy_for_long_let_fewer_in_but_never_fewer_than_cores(
    stalled: float | None,
) -> None:
    assert steps([Load(0.0, stalled, 8 * GIB)] * 4) == [4, 4, 4, 4, 3]
    assert steps([Load(0.0, stalled, 8 * GIB)] * 40)[-1] == 2


def test_busy_processors_that_nobody_waits_for_are_just_right() -> None:
    assert steps([Load(0.0, 0.4, 8 * GIB)] * 20)[-1] == 4


def test_memory_counts_before_processors() -> None:
    assert steps([Load(0.9, 0.0, 1_100_000_000)] * 3) == [4, 4, 4, 4]
    assert steps([Load(0.9, 0.0, 900_000_000)] * 5) == [4, 3, 2, 1, 1, 1]


@pytest.mark.parametrize(("gib", "most"), [(64, 24), (16, 24), (8, 11), (4, 4), (2, 1)])
def test_there_are_never_more_than_have_room_if_each_takes_its_share(gib: int, most: int) -> None:
    free = gib * GIB
    # Nobody has taken anything yet, so the looks alone would let in more and more.
    found = steps([Load(0.9, 0.0, free)] * 100, free_bytes=free)
    assert max(found) == most
    assert most == 1 or most * BOX_BYTES < free


def test_the_machine_is_looked_at() -> None:
    load = Machine().look()
    assert load.free_bytes > 0
    assert load.stalled is None or load.stalled >= 0


def test_a_gate_lets_in_so_many_and_more_when_it_may() -> None:
    gate = Gate(1)
    assert gate.enter()
    inside = threading.Event()

    def enter() -> None:
        if gate.enter():
            inside.set()

    thread = threading.Thread(target=enter)
    thread.start()
    assert not inside.is_set()
    gate.allow(2)
    thread.join(10)
    assert inside.is_set()
    assert gate.inside == 2


def test_a_closed_gate_wakes_who_waits() -> None:
    gate = Gate(0)
    answers: list[bool] = []
    thread = threading.Thread(target=lambda: answers.append(gate.enter()))
    thread.start()
    gate.close()
    thread.join(10)
    assert answers == [False]
