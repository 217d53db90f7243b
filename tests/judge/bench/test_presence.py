"""What the graph tells is asked in the order in which it is announced."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from autograder.judge.bench import graph
from autograder.judge.bench.presence import Presence
from autograder.judge.bench.recorder import Recorder

if TYPE_CHECKING:
    import pytest

    from autograder.judge.subjects.subject import Subject

TOPIC, TYPE = "/chatter", "std_msgs/msg/String"


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

    def survey(_: Any) -> graph.Interface:
        empty: graph.Interface = {role: {} for role in graph.ROLES}
        return {**empty, "publisher": {TOPIC: TYPE}} if announced else empty

    monkeypatch.setattr(graph, "shows", shows)
    monkeypatch.setattr(graph, "survey", survey)
    monkeypatch.setattr(graph, "subject_nodes", lambda *_: [])
    monkeypatch.setattr(graph, "topic_ends", lambda *_: [])
    recorder = Recorder()
    recorder.begin("a part", {})
    presence = Presence(cast("Any", None), recorder, cast("Subject", _ASubject()), settled=1.0)
    assert presence.await_endpoint("publisher", TOPIC)
    assert recorder.part().endpoints("publisher") == {TOPIC: TYPE}
