"""Whether a subject hangs is asked at the end of each run in which it was silent, whatever the scenario asks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.judge.bench.subject_time import Unanswered
from autograder.kit.bench import Pace
from autograder.kit.evidence import Reference
from tests.cases import cases, named_cases

if TYPE_CHECKING:
    from conftest import BenchOf

pytestmark = pytest.mark.ros

NODE = cases(__file__, "NODE")
REFERENCE = Reference("lab.listener", {"subscription": {"/chatter": "std_msgs/msg/String"}})


@pytest.mark.parametrize(
    ("does", "spins", "unanswered"), named_cases(__file__, "a_silent_subject_is_asked_at_the_end_of_its_run")
)
def test_a_silent_subject_is_asked_at_the_end_of_its_run(
    bench_of: BenchOf, does: str, spins: str, unanswered: bool
) -> None:
    with bench_of(NODE.format(does=does, spins=spins), REFERENCE) as bench:
        bench.part("heard")
        speaker = bench.speak("/chatter", "std_msgs/msg/String")
        bench.start()
        assert bench.await_endpoint("subscription", "/chatter")
        speaker.send(data="hello")
        bench.wait_until(lambda evidence: bool(evidence.main.said()), 2.0)
        bench.stop()
        (part,) = bench.parts
    assert bool(part.of("unanswered")) is unanswered
    assert bool(part.of("stack")) is unanswered


def test_a_fast_look_at_a_node_that_nothing_spins_ends_at_once(bench_of: BenchOf) -> None:
    with bench_of(NODE.format(does="None", spins="time.sleep(60)"), REFERENCE, Pace.FAST) as bench:
        bench.part("heard")
        bench.speak("/chatter", "std_msgs/msg/String")
        bench.start()
        assert bench.await_endpoint("subscription", "/chatter")
        with pytest.raises(Unanswered):
            bench.await_attention()
        bench.stop()
        (part,) = bench.parts
    assert part.of("unanswered")
    assert not part.of("stack")
