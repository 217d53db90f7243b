"""When the graph counts as known, with a clock that only the test moves."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import pytest

from course_runtime.ros2_command.discovery import Graph, wait_until_settled
from course_runtime.ros2_command.ports import Ports

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_runtime.ros2_command.roll_call import RollCall

OWN, TALKER, LISTENER = b"own", b"talker", b"listener"


@dataclass
class World:
    """Participants that answer a while after they were asked, and a graph that changes (all in seconds).

    Attributes:
        answers: How long after a call each of them answers.
        graphs: What is known from when on.
        ports: How many of them hold a port.
    """

    answers: dict[bytes, float]
    graphs: list[tuple[float, Graph]]
    ports: int | None = None
    strangers: frozenset[bytes] = frozenset()
    now: float = 0.0
    called: float = 0.0
    answered: set[bytes] = field(default_factory=set)
    calls: int = 0

    def call(self, ports: Iterable[int]) -> None:
        self.answered, self.called, self.calls = set(), self.now, self.calls + 1

    def listen(self, own_ports: Iterable[int]) -> None:
        self.answered |= {who for who, after in self.answers.items() if self.now - self.called >= after}

    def look(self) -> Graph:
        return [graph for since, graph in self.graphs if since <= self.now][-1]

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def wait(self, shortest: float = 0.0) -> int:
        """Wait as the command does; how many were not met."""
        number = len(self.answers) + len(self.strangers) if self.ports is None else self.ports
        return wait_until_settled(
            self.look,
            cast("RollCall", self),
            lambda: Ports(frozenset({1}), frozenset(range(2, number + 2))),
            shortest,
            longest=15.0,
            clock=lambda: self.now,
            sleep=self.sleep,
        )


def graph(*met: bytes, content: object = "", named: bool = True) -> Graph:
    return Graph(frozenset(met), named, content)


def test_alone_there_is_nothing_to_wait_for() -> None:
    world = World({}, [(0.0, graph(OWN))])
    assert world.wait() == 0
    assert world.now < 0.2


def test_a_late_answer_is_waited_for_however_late_it_is() -> None:
    world = World({TALKER: 0.0}, [(0.0, graph(OWN)), (9.0, graph(OWN, TALKER))])
    assert world.wait() == 0
    assert world.now > 9.0


def test_who_is_still_being_made_is_asked_again() -> None:
    world = World({TALKER: 0.1}, [(0.0, graph(OWN, TALKER))], ports=2)
    world.answers[LISTENER] = 1e9
    world.graphs.append((2.0, graph(OWN, TALKER, LISTENER)))
    plain = world.listen

    def listen(own_ports: Iterable[int]) -> None:
        if world.now >= 2.0:
            world.answers[LISTENER] = 0.0
        plain(own_ports)

    world.listen = listen  # type: ignore[method-assign]
    assert world.wait() == 0
    assert world.calls > 3
    assert world.now > 2.0


def test_names_are_waited_for() -> None:
    unnamed, known = graph(OWN, TALKER, named=False), graph(OWN, TALKER, content="by talker")
    world = World({TALKER: 0.0}, [(0.0, unnamed), (1.3, known)])
    assert world.wait() == 0
    assert world.now > 1.3


def test_who_goes_on_having_no_name_is_not_waited_for_to_the_end() -> None:
    world = World({TALKER: 0.0}, [(0.0, graph(OWN, TALKER, named=False))])
    assert world.wait() == 0
    assert world.now < 5.0


def test_news_ask_for_one_more_quiet_round() -> None:
    world = World({TALKER: 0.0}, [(0.02 * i, graph(OWN, TALKER, content=i)) for i in range(10)])
    assert world.wait() == 0
    assert world.now > 0.18 + 0.06


def test_a_busy_machine_makes_the_round_as_long_as_its_answers() -> None:
    world = World({TALKER: 0.25}, [(0.0, graph(OWN, TALKER)), (0.2, graph(OWN, TALKER, content="more"))])
    assert world.wait() == 0
    assert world.calls == 2
    assert world.now > 0.5


def test_who_never_answers_is_given_up_and_counted() -> None:
    world = World({TALKER: 1e9}, [(0.0, graph(OWN))])
    assert world.wait() == 1
    assert world.now >= 15.0


def test_who_answers_and_never_tells_its_nodes_is_counted() -> None:
    world = World({TALKER: 0.0}, [(0.0, graph(OWN))])
    assert world.wait() == 1


def test_a_participant_that_is_not_of_ros_is_not_waited_for() -> None:
    world = World({}, [(0.0, graph(OWN))], strangers=frozenset({b"other"}))
    assert world.wait() == 0
    assert world.now < 0.2


@pytest.mark.parametrize("shortest", [0.4, 2.0])
def test_a_given_time_is_kept(shortest: float) -> None:
    world = World({}, [(0.0, graph(OWN))])
    assert world.wait(shortest) == 0
    assert world.now >= shortest
