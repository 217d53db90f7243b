"""What is sent to a subject must not be lost because its own side does not know the judge's publisher yet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.evidence import Evidence, Reference
from autograder.kit.reported_texts import is_said
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from autograder.judge.bench.bench import TestBench

    BenchOf = Callable[[str, Reference], AbstractContextManager[TestBench]]

pytestmark = pytest.mark.ros

TOPIC, TYPE = "/chatter", "std_msgs/msg/String"
TIMES = 5
"""Without the wait about every second text was lost."""
BEST_EFFORT_LISTENER = cases(__file__, "BEST_EFFORT_LISTENER")


def test_a_best_effort_listener_hears_the_first_text_of_a_publisher_it_meets_last(bench_of: BenchOf) -> None:
    with bench_of(BEST_EFFORT_LISTENER, Reference("a test", {"subscription": {TOPIC: TYPE}})) as bench:
        for turn in range(TIMES):
            assert _is_heard(bench, f"text {turn}")


def _is_heard(bench: TestBench, text: str) -> bool:
    def said(evidence: Evidence) -> bool:
        return is_said(text, evidence.main)

    bench.part(text)
    bench.start()
    assert bench.await_endpoint("subscription", TOPIC)
    # Made now, the publisher is matched with the subscription at once, and the subscription with it a moment later.
    speaker = bench.speak(TOPIC, TYPE)
    assert bench.await_endpoint("subscription", TOPIC)
    bench.await_attention()
    speaker.send(data=text)
    heard = bench.wait_until(said, 10.0)
    bench.stop()
    return heard
