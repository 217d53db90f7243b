"""How long the command looks at the graph, with a clock that only the test moves."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from environment.ros2_command import discovery
from environment.ros2_command.discovery import Graph, participants_here, ports_in_use, wait_until_known
from environment.ros2_command.participant import threads_wait_for_creator

if TYPE_CHECKING:
    from pathlib import Path


class World:
    """A graph that changes at given times (seconds)."""

    def __init__(self, *changes: tuple[float, Graph]) -> None:
        self.changes, self.now = changes, 0.0

    def observe(self) -> Graph:
        return [graph for since, graph in self.changes if since <= self.now][-1]

    def wait(self, expected: int | None, shortest: float = 0.0, *, names: bool = True) -> bool:
        return wait_until_known(
            self.observe,
            expected,
            shortest,
            names=names,
            longest=1.0,
            clock=lambda: self.now,
            sleep=self.sleep,
        )

    def sleep(self, seconds: float) -> None:
        self.now += seconds


ALONE = Graph(1, True, "own")
UNNAMED = Graph(2, False, "chatter")
KNOWN = Graph(2, True, "chatter by talker")


def test_alone_there_is_nothing_to_wait_for() -> None:
    world = World((0.0, ALONE))
    assert world.wait(expected=1)
    assert world.now < 0.06


def test_everybody_on_this_machine_is_waited_for() -> None:
    world = World((0.0, ALONE), (0.08, UNNAMED), (0.16, KNOWN))
    assert world.wait(expected=2)
    assert 0.16 < world.now < 0.25


def test_names_are_waited_for_only_when_they_are_needed() -> None:
    world = World((0.0, ALONE), (0.08, UNNAMED), (0.5, KNOWN))
    assert world.wait(expected=2, names=False)
    assert world.now < 0.2


def test_names_may_come_later_than_the_time_to_meet_somebody() -> None:
    world = World((0.0, ALONE), (0.9, UNNAMED), (1.3, KNOWN))
    assert world.wait(expected=2)
    assert world.now > 1.3


def test_who_never_answers_is_given_up() -> None:
    world = World((0.0, ALONE))
    assert not world.wait(expected=2)
    assert 1.0 <= world.now < 1.1


def test_news_prolong_the_wait() -> None:
    world = World((0.0, ALONE), *[(0.02 * i, Graph(2, True, i)) for i in range(1, 10)])
    assert world.wait(expected=2)
    assert world.now > 0.18 + discovery._QUIET - 0.01


def test_a_given_time_is_kept() -> None:
    world = World((0.0, ALONE))
    assert world.wait(expected=1, shortest=2.0)
    assert world.now >= 2.0


def test_participants_are_counted_by_their_ports() -> None:
    # Domain 42 begins at 17900; its participants take 17910, 17912, …; 17911 is the first one's other port.
    ports = {17910, 17911, 17912, 7410, 18160}
    assert participants_here(42, ports) == 2
    assert participants_here(43, ports) == 1
    assert participants_here(1, ports) == 0
    assert participants_here(0, None) is None


def test_ports_are_read_from_the_tables_of_linux(tmp_path: Path) -> None:
    table = tmp_path / "udp"
    table.write_text(
        "  sl  local_address rem_address   st tx_queue\n"
        "  12: 00000000:45F6 00000000:0000 07 00000000:00000000\n"
        "  13: 0100007F:0035 00000000:0000 07 00000000:00000000\n"
    )
    assert ports_in_use([str(table), str(tmp_path / "missing")]) == {17910, 53}
    assert ports_in_use([str(tmp_path / "missing")]) is None


@pytest.mark.parametrize("text", ["abc", "-1", "300", "1.5"])
def test_a_wrong_domain_is_named(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    with pytest.raises(RuntimeError, match="ROS_DOMAIN_ID is"):
        discovery.domain_id()


def test_where_other_machines_may_answer_they_get_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    assert discovery.shortest_wait(None, 1) == pytest.approx(0.4)
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    assert discovery.shortest_wait(None, 1) == 0.0
    assert discovery.shortest_wait(2.5, 1) == 2.5


def test_scheduling_is_as_before_afterwards() -> None:
    before = (os.sched_getaffinity(0), os.sched_getscheduler(0))
    with threads_wait_for_creator():
        assert os.sched_getscheduler(0) == os.SCHED_BATCH
        assert len(os.sched_getaffinity(0)) == 1
    assert (os.sched_getaffinity(0), os.sched_getscheduler(0)) == before
