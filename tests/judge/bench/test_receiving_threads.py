"""The middleware's threads have had their turns: told from what the kernel says of them, no ROS is started."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import pytest

from autograder.judge.bench import judge_nodes
from autograder.judge.bench.judge_nodes import _Thread, await_turns
from autograder.judge.machine_fitness import Patience

if TYPE_CHECKING:
    from collections.abc import Iterable

RECEIVER, ANNOUNCER = 1_000_001, 1_000_002
ASLEEP, AWAKE = _Thread(False, 7), _Thread(True, 7)


class Kernel:
    """Tells something else of a thread at each look; the last of it for ever."""

    def __init__(self, **told: list[_Thread]) -> None:
        self._told = {RECEIVER: told["receiver"], ANNOUNCER: told.get("announcer", [ASLEEP])}
        self.looks = 0

    def look(self, tasks: Iterable[int]) -> dict[int, _Thread]:
        wanted = set(tasks)
        everybody = not wanted <= set(self._told)
        self.looks += 1
        return {
            task: told.pop(0) if len(told) > 1 else told[0]
            for task, told in self._told.items()
            if everybody or task in wanted
        }


@pytest.mark.parametrize(
    ("receiver", "looks"),
    [
        pytest.param([ASLEEP], 2, id="all asleep"),
        pytest.param([AWAKE, AWAKE, ASLEEP], 4, id="one falls asleep"),
        pytest.param([AWAKE, AWAKE, _Thread(True, 8), ASLEEP], 4, id="one has slept, and is awake again"),
    ],
)
def test_a_turn_ends_in_sleep(receiver: list[_Thread], looks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = Kernel(receiver=receiver)
    monkeypatch.setattr(judge_nodes, "_thread_states", kernel.look)
    assert await_turns(Patience(60.0))
    assert kernel.looks == looks


def test_who_never_sleeps_uses_up_the_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = Kernel(receiver=[AWAKE])
    monkeypatch.setattr(judge_nodes, "_thread_states", kernel.look)
    assert not await_turns(Patience(0.05))


def test_the_kernel_tells_of_threads_that_are_there_and_of_no_others() -> None:
    own, nobody = threading.get_native_id(), 2**22 + 1
    seen = judge_nodes._thread_states([own, nobody])
    assert set(seen) == {own}
    assert seen[own].awake
