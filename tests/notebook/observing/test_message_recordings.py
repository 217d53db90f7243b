"""A recording holds what was sent, and other programs can read it."""

from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING

import pytest
from geometry_msgs.msg import TwistStamped
from mcap.reader import make_reader
from rclpy.exceptions import NotInitializedException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from autograder.mcap_files import definition
from autograder.notebook.observing.message_recordings import read_recording, recording

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

pytestmark = pytest.mark.ros


def test_what_was_sent_is_read_back(ros: None, tmp_path: Path, until: Callable[..., object]) -> None:
    path = tmp_path / "hello.mcap"
    node = Node("talker")
    publisher = node.create_publisher(String, "chatter", 10)
    moves = node.create_publisher(TwistStamped, "moves", 10)
    before = time.time()
    with recording(path) as recorder:
        until(lambda: publisher.get_subscription_count() and moves.get_subscription_count())
        for number in range(20):
            publisher.publish(String(data=f"Hello, world! {number}"))
        move = TwistStamped()
        move.header.frame_id = "map"
        move.twist.linear.x = 0.25
        moves.publish(move)
        until(lambda: recorder.counts == {"/chatter": 20, "/moves": 1})
    found = list(read_recording(path))
    texts = [one for one in found if one.topic == "/chatter"]
    assert [one.message.data for one in texts] == [f"Hello, world! {number}" for number in range(20)]
    assert {one.type for one in texts} == {"std_msgs/msg/String"}
    (moved,) = read_recording(path, ["/moves"])
    assert (moved.message.header.frame_id, moved.message.twist.linear.x) == ("map", 0.25)
    assert all(before <= one.t <= time.time() for one in found)
    assert repr(recorder).endswith("20 on /chatter, 1 on /moves")
    node.destroy_node()


def test_the_file_is_as_ros2_bag_and_foxglove_expect_it(
    ros: None, tmp_path: Path, until: Callable[..., object]
) -> None:
    path = tmp_path / "hello.mcap"
    node = Node("talker")
    publisher = node.create_publisher(String, "chatter", 10)
    with recording(path, ["chatter"]) as recorder:
        until(publisher.get_subscription_count)
        publisher.publish(String(data="x"))
        until(lambda: recorder.counts["/chatter"] == 1)
    with path.open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == 1
        (channel,), (schema,) = summary.channels.values(), summary.schemas.values()
    assert (channel.topic, channel.message_encoding) == ("/chatter", "cdr")
    assert (schema.name, schema.encoding) == ("std_msgs/msg/String", "ros2msg")
    node.destroy_node()


def test_what_was_said_before_is_recorded_where_its_publisher_keeps_it(
    ros: None, tmp_path: Path, until: Callable[..., object]
) -> None:
    node = Node("map_server")
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(String, "map", kept).publish(String(data="the map"))
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    scans = node.create_publisher(String, "scan", best_effort)
    with recording(tmp_path / "a.mcap") as recorder:
        until(lambda: recorder.counts.get("/map") == 1)
        until(scans.get_subscription_count)
    assert [one.message.data for one in read_recording(tmp_path / "a.mcap", ["/map"])] == ["the map"]
    node.destroy_node()


def test_a_block_that_fails_leaves_a_file_that_can_be_read(ros: None, tmp_path: Path) -> None:
    def fail() -> None:
        with recording(tmp_path / "a.mcap"):
            raise RuntimeError("no such robot")

    with pytest.raises(RuntimeError, match="no such robot"):
        fail()
    assert list(read_recording(tmp_path / "a.mcap")) == []


def test_without_ros_a_recording_that_is_there_stays(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_bytes(b"recorded yesterday")
    with pytest.raises(NotInitializedException), recording(tmp_path / "a.mcap"):
        pass
    assert (tmp_path / "a.mcap").read_bytes() == b"recorded yesterday"


def test_another_ending_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"such as hello\.mcap"):
        recording(tmp_path / "hello.bag")


def test_a_definition_brings_those_of_its_fields() -> None:
    text = definition("geometry_msgs/msg/TwistStamped")
    named = [line.removeprefix("MSG: ") for line in text.splitlines() if line.startswith("MSG: ")]
    assert sorted(named) == sorted(
        ["std_msgs/Header", "geometry_msgs/Twist", "geometry_msgs/Vector3", "builtin_interfaces/Time"]
    )
    assert all(a != b for a, b in itertools.pairwise(named))
    with pytest.raises(LookupError, match="no_such_msgs/msg/Nothing"):
        definition("no_such_msgs/msg/Nothing")
