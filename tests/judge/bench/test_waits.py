"""A wait says whether its condition held when it was asked last, and does not ask again."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING
from unittest.mock import create_autospec

from autograder.judge.bench.bench import TestBench
from autograder.judge.bench.recorder import Recorder
from autograder.judge.bench.subject_presence import Presence
from autograder.kit.bench import Pace
from autograder.kit.evidence import Evidence, Reference

if TYPE_CHECKING:
    import pytest


class _Subject:
    """Ends, or not; what else a subject does is not asked for."""

    shares_participant = False

    def __init__(self, *, ends: bool) -> None:
        self.ended = ends


def _bench(*, ends: bool = False) -> TestBench:
    subject = _Subject(ends=ends)
    return TestBench(subject, 0, Reference("a test", {}), Pace.FAST, Random("a seed"))  # type: ignore[arg-type]


def _once(_: Evidence, asked: list[int]) -> bool:
    """Holds the first time that it is asked, as something that is true for a moment."""
    asked.append(1)
    return len(asked) == 1


def test_a_condition_that_holds_for_a_moment_has_held() -> None:
    asked: list[int] = []
    assert _bench().wait_until(lambda evidence: _once(evidence, asked), 5.0)
    assert len(asked) == 1


def test_on_the_graph_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(TestBench, "_presence", create_autospec(Presence))
    asked: list[int] = []
    assert _bench().watch_graph(lambda evidence: _once(evidence, asked), 5.0)
    assert len(asked) == 1


def test_what_never_holds_does_not() -> None:
    assert not _bench().wait_until(lambda _: False, 0.0)
    assert not _bench(ends=True).wait_until(lambda _: False, 60.0)


def test_a_server_is_late_by_the_clock_on_the_wall_however_busy_the_machine_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bench, wait = _bench(), create_autospec(Recorder.wait)
    monkeypatch.setattr(Recorder, "wait", wait)
    bench.let_wait(0.5)
    assert wait.call_args.kwargs == {"wall": True}
