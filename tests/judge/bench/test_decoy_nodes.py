"""A run begins once its subject knows the planted nodes: what one look at the graph shows is no matter of timing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
import rclpy

from autograder.judge.subject import CommandSubject
from autograder.kit.evidence import Reference
from autograder.notebook.checking.judge_link import CheckContext

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from autograder.judge.bench.bench import TestBench
    from autograder.judge.bench.discovery import Endpoint

    BenchOf = Callable[[str, Reference], AbstractContextManager[TestBench]]

pytestmark = pytest.mark.ros

PLANTED: dict[str, Any] = {
    "publishes": {"/a": "std_msgs/msg/String"},
    "subscribes": {"/b": "std_msgs/msg/Bool"},
}


def test_a_run_waits_until_the_planted_nodes_are_known_and_the_earlier_ones_gone(
    bench_of: BenchOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    met: list[list[str]] = []
    with bench_of("", Reference("a test", {})) as bench, CheckContext(bench._domain_id, "_keeper") as own:
        own.ensure(fresh=True)

        def knows(_: CommandSubject, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
            met.append(sorted(topic for topic, _ in there))
            return own.sees(sorted(there), sorted(gone), 10.0)

        monkeypatch.setattr(CommandSubject, "knows", knows)
        # So that the judge has one participant for all parts, and what is gone can be asked for.
        monkeypatch.setattr(CommandSubject, "shares_participant", True)
        for name in ("first", "second"):
            bench.part(name)
            bench.plant(name, **PLANTED)
            bench.start()
            node = rclpy.create_node("looking")
            assert "/a" in dict(node.get_publisher_names_and_types_by_node(name, "/"))
            node.destroy_node()
            bench.await_end(20.0)
        bench.part("nothing is planted")
        bench.start()
    assert met == [["rt/a", "rt/b"], ["rt/a", "rt/b"], []]
