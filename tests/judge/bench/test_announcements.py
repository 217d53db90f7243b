"""A program that has made a node was heard, however soon it was gone."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from typing import TYPE_CHECKING, Any, cast

import pytest

from autograder.judge import ros_setup
from autograder.judge.bench.discovery import MAX_PROCESSES, Announcements, _waiting, process_of
from autograder.judge.bench.judge_nodes import Wire
from autograder.judge.bench.recorded_topics import LogReader
from autograder.judge.bench.recorder import Recorder
from autograder.judge.ros_setup import subject_environment

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.ros

LOGS = "import rclpy\nfrom rclpy.logging import get_logger\nrclpy.init()\nget_logger('simple_node').info('Hello')\n"
MAKES_A_NODE = "import os, rclpy\nrclpy.init()\nrclpy.create_node('simple_node')\nos._exit(0)\n"


@pytest.fixture
def domain_id() -> Iterator[int]:
    with ros_setup.lease_domain() as leased:
        yield leased


@pytest.mark.parametrize("boxed", [False, True])
@pytest.mark.parametrize(("program", "processes"), [(MAKES_A_NODE, 1), (LOGS, 0)])
def test_who_made_a_node_was_heard(domain_id: int, boxed: bool, program: str, processes: int) -> None:
    with contextlib.closing(Announcements(domain_id)) as announcements:
        run(program, subject_environment(domain_id, boxed=boxed))
        assert len(announcements.heard()) == processes


def test_the_judge_s_own_node_is_known_from_a_subject_s(domain_id: int) -> None:
    recorder = Recorder()
    with (
        contextlib.closing(Announcements(domain_id)) as announcements,
        contextlib.closing(Wire(domain_id)) as wire,
    ):
        LogReader(wire, lambda: recorder)
        run(MAKES_A_NODE, subject_environment(domain_id))
        own = process_of(wire.node)
        assert own[4:6] == os.getpid().to_bytes(4, "little")[:2]
        assert len(announcements.heard() - {own}) == 1


class _Flooded:
    """A socket at which there is always one more message."""

    def recv(self, _: int) -> bytes:
        return b"RTPS"


def test_a_flood_does_not_hold_the_judge_up() -> None:
    assert len(list(_waiting(cast("Any", _Flooded())))) == MAX_PROCESSES


def run(program: str, environment: dict[str, str]) -> None:
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
