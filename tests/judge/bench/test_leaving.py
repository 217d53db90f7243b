"""A program that leaves the graph is on its way out: how it ends is seen, whenever it was looked at."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.kit.evidence import Evidence, Reference
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager
    from pathlib import Path

    from autograder.judge.bench.bench import TestBench

    BenchOf = Callable[[str, Reference], AbstractContextManager[TestBench]]

pytestmark = pytest.mark.ros

TOPIC, TYPE = "/chatter", "std_msgs/msg/String"
LEAVING_TALKER = cases(__file__, "LEAVING_TALKER")
"""Without the wait its last words were lost, and that it ends by itself."""


def test_what_a_program_says_after_it_left_the_graph_is_heard(bench_of: BenchOf, tmp_path: Path) -> None:
    with bench_of(LEAVING_TALKER, Reference("a test", {"publisher": {TOPIC: TYPE}})) as bench:
        bench.part("leaving")
        bench.listen(TOPIC, TYPE)
        bench.start(str(sign := tmp_path / "leave now"))
        assert bench.await_endpoint("publisher", TOPIC)
        sign.touch()
        bench.watch_graph(_has_left, 10.0)  # or until it has ended
        bench.stop()
    (part,) = bench.parts
    assert part.ending is not None
    assert part.said() == ["last words"]


def _has_left(evidence: Evidence) -> bool:
    return not evidence.main.of("interface", "graph")[-1].data["publisher"]
