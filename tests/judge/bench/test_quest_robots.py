"""A subject finds the robot that a quest draws, with its namespace, also when half of it comes late."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from autograder.kit.counterparts import Qos
from autograder.kit.draft import Draft
from autograder.kit.evidence import Evidence, Reference
from autograder.kit.quests.quest import Quest
from autograder.kit.quests.robot import Robot
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager
    from random import Random

    from autograder.judge.bench.bench import TestBench

    BenchOf = Callable[[str, Reference], AbstractContextManager[TestBench]]

pytestmark = pytest.mark.ros

FINDS = cases(__file__, "FINDS")


def robots(random: Random) -> dict[str, Robot]:
    """A robot that is there, and one whose motors come late."""
    drawn = {}
    for name, called in zip(("there", "late"), random.sample(("mia", "noa", "ada"), 2), strict=True):
        topic, motors = f"/{called}/{random.choice(('go', 'drive', 'steer'))}", f"/{called}/motors"
        drawn[name] = Robot(
            answer={"robot": called, "topic": topic},
            nodes={
                f"/{called}/camera": {
                    "publishes": {f"/{called}/image": "std_msgs/msg/String"},
                    "qos": Qos.SENSOR,
                },
                motors: {"subscribes": {topic: "geometry_msgs/msg/Twist"}},
            },
            late=[motors] if name == "late" else [],
        )
    return drawn


@pytest.mark.parametrize(("program", "points"), [(FINDS, 10), (FINDS.replace("obeyed[0]", "'/go'"), 4)])
def test_a_program_finds_what_the_judge_drew(bench_of: BenchOf, program: str, points: float) -> None:
    quest = Quest(robots)
    draft = Draft("a.quest", "A", "B", quest)
    draft.asks("robot", "Finds what the robot is called", quest.finds("robot"), points=4)
    draft.asks("topic", "Finds the topic that it obeys", quest.finds("topic"), points=6)
    reference = Reference("a.quest", {})
    with bench_of(program, reference) as bench:
        quest.scenario(bench)
        evidence = Evidence(bench.parts, reference)
    json.dumps([part.inputs for part in evidence])  # as kept evidence needs
    judged = draft.exercise().criteria
    assert [part.name for part in evidence] == ["there", "late"]
    assert sum(criterion.points for criterion in judged if criterion.judge(evidence).passed) == points
