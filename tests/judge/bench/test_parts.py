"""The parts of one look: each has its own record."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.evidence import Reference

if TYPE_CHECKING:
    from tests.judge.bench.conftest import BenchOf

pytestmark = pytest.mark.ros


def test_an_answer_that_arrives_after_its_part_is_not_one_of_the_next_part(bench_of: BenchOf) -> None:
    with bench_of("", Reference("a test", {})) as bench:
        bench.part("goals")
        client = bench.call_action("/fibonacci", "my_robot_interfaces/action/Fibonacci")
        listener = bench.speak("/chatter", "std_msgs/msg/String")
        bench.part("bad orders")
        # On a busy machine, the judge's thread has taken these before the end of the part, and records them after it.
        client._note("result_heard", 0, status=6, fields={})
        listener._place.record("matched", count=1, now=1)
        assert [event.kind for event in bench.seen().events] == []
