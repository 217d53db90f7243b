"""Workspaces that a notebook's check is given the path of: what runs in them are processes of their own."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))
from checked import a_judge

from tests.measure.bank import answer_named

pytestmark = [pytest.mark.ros, pytest.mark.slow]

BLIND = """
from autograder.judge.bench import discovery
discovery.subject_nodes = lambda *_, **__: []
"""


def test_a_node_is_there_though_the_graph_had_no_time_to_tell(tmp_path: Path) -> None:
    answer = answer_named("lab_1_1.hello/right/ends_after_its_line.workspace")
    *_, workspace = answer.unpack(tmp_path)
    with a_judge(change=BLIND) as check:
        verdict = check("lab_1_1.hello", workspace)
    assert verdict.passed, [(criterion.name, criterion.seen) for criterion in verdict.criteria]
