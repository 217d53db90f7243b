"""A subject that says very much at once is judged as any other; where the conversation ends, that is what is told."""

from __future__ import annotations

import socket
from typing import TYPE_CHECKING

import pytest
from rclpy.node import Node
from std_msgs.msg import String

from autograder.messages.judge_messages import Constructed, Started
from autograder.notebook.checking.judge_link import JudgeLink

if TYPE_CHECKING:
    from autograder.messages.json_lines import Message
    from tests.notebook.checked import Checked

pytestmark = pytest.mark.ros


class TalkerNode(Node):
    """Says a megabyte in one line, in print and in its log, and then what it should."""

    def __init__(self) -> None:
        super().__init__("talker_node")
        print("." * 1_100_000)
        self.get_logger().info("." * 1_100_000)  # type: ignore[no-untyped-call]
        self.talker = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, self.tick)
        self.i = 0

    def tick(self) -> None:
        self.talker.publish(String(data=f"Hello, world! {self.i}"))
        self.i += 1


def test_a_line_of_a_megabyte_costs_no_points(checked: Checked) -> None:
    verdict = checked("lab_1_2.talker", TalkerNode)
    assert verdict.score == verdict.max_score


def test_a_conversation_that_ended_is_named(monkeypatch: pytest.MonkeyPatch, checked: Checked) -> None:
    say = JudgeLink.say

    def hang_up(link: JudgeLink, message: Message) -> None:
        if isinstance(message, Started | Constructed):
            link._lines._socket.shutdown(socket.SHUT_WR)
        say(link, message)

    monkeypatch.setattr(JudgeLink, "say", hang_up)
    verdict = checked("lab_1_2.talker", TalkerNode)
    assert not verdict.passed
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.key == "cut_off"
