"""What the graph tells is asked in the order in which it is announced, and who is still at work is waited for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import pytest

from autograder.judge.bench import discovery
from autograder.judge.bench import subject_presence as presence_module
from autograder.judge.bench.recorder import Recorder
from autograder.judge.bench.subject_presence import GRAPH_POLL, MAX_RESTARTS, START_POLL, Presence
from autograder.kit.bench import Pace

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.judge.subject import Subject


TOPIC, TYPE = "/chatter", "std_msgs/msg/String"


def _interface(*, publishes: bool = False) -> discovery.Interface:
    return {role: {TOPIC: TYPE} if publishes and role == "publisher" else {} for role in discovery.ROLES}


def _presence(
    monkeypatch: pytest.MonkeyPatch,
    subject: object,
    survey: Callable[[Any], discovery.Interface],
    *,
    nodes: Sequence[discovery.NodeName] = (),
    announced: bool = False,
) -> tuple[Presence, Recorder]:
    """A subject's presence on a graph that shows this, and where it is written down."""
    monkeypatch.setattr(discovery, "survey", lambda judge, _=None: survey(judge))
    monkeypatch.setattr(discovery, "every_node", lambda *_: nodes)
    monkeypatch.setattr(discovery, "topic_ends", lambda *_: [])
    recorder = Recorder()
    seen = cast("Subject", subject)
    return Presence(cast("Any", None), recorder, seen, Pace.FAST, announced=lambda: announced), recorder


class _ASubject:
    """One in a notebook, which puts up a sign when it has made all that it makes."""

    shares_participant, keeper, marker, ended = True, "", "/all_made", False


def test_a_publisher_that_comes_with_the_sign_that_all_is_made_is_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The publisher is announced before the sign, and both between the same two looks."""
    announced: list[bool] = []

    def shows(*_: Any) -> bool:
        announced.append(True)
        return True

    def survey(_: Any) -> discovery.Interface:
        return _interface(publishes=bool(announced))

    monkeypatch.setattr(discovery, "shows", shows)
    presence, recorder = _presence(monkeypatch, _ASubject(), survey)
    assert presence.await_endpoint("publisher", TOPIC)
    assert recorder.part().endpoints("publisher") == {TOPIC: TYPE}


class _ACommand:
    """One that builds, or hangs, before it makes its publisher."""

    shares_participant, keeper, marker, ended = False, "", None, False

    def __init__(self, works_for: int) -> None:
        self.asked, self._works_for = 0, works_for

    def processes(self) -> frozenset[int]:
        """Asked twice in each span of patience; in those in which it works, another process lives then."""
        self.asked += 1
        return frozenset({self.asked if self.asked <= 2 * self._works_for else 0})


@pytest.mark.parametrize(
    ("works_for", "publishes_after", "appears", "spans"),
    [
        pytest.param(MAX_RESTARTS, MAX_RESTARTS, True, MAX_RESTARTS, id="it builds and then publishes"),
        pytest.param(0, 99, False, 1, id="it hangs: nothing more is waited for"),
        pytest.param(99, 99, False, MAX_RESTARTS + 1, id="it starts processes for ever"),
    ],
)
def test_who_goes_on_starting_processes_is_waited_for(
    monkeypatch: pytest.MonkeyPatch, works_for: int, publishes_after: int, appears: bool, spans: int
) -> None:
    subject = _ACommand(works_for)

    def survey(_: Any) -> discovery.Interface:
        return _interface(publishes=subject.asked >= 2 * publishes_after)

    monkeypatch.setattr(presence_module, "APPEAR", 0.2)
    presence, _ = _presence(monkeypatch, subject, survey)
    assert presence.await_endpoint("publisher", TOPIC) is appears
    assert (subject.asked + 1) // 2 == spans


class _AProgram:
    """One that has ended."""

    shares_participant, keeper, marker, ended = False, "", None, True


@pytest.mark.parametrize(
    ("announced", "shown", "events"),
    [
        pytest.param(True, [], ["interface", "announced"], id="the graph never told of it"),
        pytest.param(True, [discovery.NodeName("talker", "/")], ["interface"], id="the graph told of it"),
        pytest.param(False, [], ["interface"], id="it never made a node"),
    ],
)
def test_a_node_that_was_there_for_a_moment_is_written_down(
    monkeypatch: pytest.MonkeyPatch, announced: bool, shown: list[discovery.NodeName], events: list[str]
) -> None:
    presence, recorder = _presence(
        monkeypatch, _AProgram(), lambda _: _interface(), nodes=shown, announced=announced
    )
    assert presence.await_node() is announced
    presence.note_short_life()
    assert [event.kind for event in recorder.part().events] == events


@pytest.mark.parametrize(
    ("announced", "polls"),
    [
        pytest.param(False, [START_POLL], id="nobody announced a node: one limit, looks that are rare"),
        pytest.param(
            True, [START_POLL, GRAPH_POLL], id="a node is about to be seen: frequent looks, in the same limit"
        ),
    ],
)
def test_the_graph_is_asked_often_once_a_node_is_announced_and_no_longer_than_was_said(
    monkeypatch: pytest.MonkeyPatch, announced: bool, polls: list[float]
) -> None:
    waits: list[tuple[float, float]] = []
    presence, recorder = _presence(monkeypatch, _ACommand(0), lambda _: _interface(), announced=announced)
    wait = recorder.wait

    def noted(condition: Callable[[], bool], within: float, *, poll: float) -> bool:
        waits.append((within, poll))
        return wait(condition, within, poll=poll)

    monkeypatch.setattr(recorder, "wait", noted)
    assert not presence.await_sign_of_life(0.1)
    assert [poll for _, poll in waits] == polls
    assert all(within <= 0.1 for within, _ in waits)


@pytest.mark.parametrize(
    ("users", "has_ended", "found", "in_vain"),
    [
        pytest.param(["talker"], False, ["talker"], [False, False, False], id="it is there"),
        pytest.param([], False, ["helper", "talker"], [True, False, True], id="none uses the topics: all"),
        pytest.param(None, False, [], [True, True, True], id="a name is still to come"),
        pytest.param([], True, [], [False, False, False], id="it has ended"),
    ],
)
def test_a_node_that_uses_the_judges_topics_is_waited_for_once(
    monkeypatch: pytest.MonkeyPatch,
    users: list[str] | None,
    has_ended: bool,
    found: list[str],
    in_vain: list[bool],
) -> None:
    """A run asks in each of its steps, and waits again only for other topics."""

    class Subject(_ASubject):
        ended = has_ended

    def nodes(names: Sequence[str]) -> list[discovery.NodeName]:
        return [discovery.NodeName(name, "/") for name in names]

    waits: list[bool] = []

    def wait(*how: Any, **more: Any) -> bool:
        held = Recorder().wait(*how, **more)
        waits.append(not held)
        return held

    presence, recorder = _presence(
        monkeypatch, Subject(), lambda _: _interface(), nodes=nodes(["talker", "helper"])
    )
    monkeypatch.setattr(recorder, "wait", wait)
    monkeypatch.setattr(discovery, "counterparts", lambda *_: None if users is None else nodes(users))
    monkeypatch.setattr(presence_module, "NAMED", 0.1)
    for topic in (TOPIC, TOPIC, "/another"):
        presence.subscriptions[topic] = cast("Any", None)
        assert [node.name for node in presence.counterparts()] == found
    assert waits == in_vain
