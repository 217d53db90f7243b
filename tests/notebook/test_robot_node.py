"""The robot as everybody else on the graph meets it."""

from __future__ import annotations

import queue
from typing import TYPE_CHECKING, Any

import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo
from std_srvs.srv import SetBool, Trigger

from autograder.notebook import robot_drivers
from autograder.notebook.nodes.background_nodes import spin_in_background
from autograder.notebook.robot_node import RobotNode
from autograder.robot.motion import START
from autograder.robot.sensors import RAYS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

pytestmark = pytest.mark.ros
LIMIT = 180.0
"""Seconds after which a test gives up waiting for an event that comes within milliseconds."""


class Driver:
    """A node beside the robot, spun by whoever waits."""

    def __init__(self) -> None:
        self.node = Node("driver")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.poses: queue.SimpleQueue[Odometry] = queue.SimpleQueue()
        self.scans: queue.SimpleQueue[LaserScan] = queue.SimpleQueue()
        self.node.create_subscription(Odometry, "/odom", self.poses.put, 10)
        self.node.create_subscription(LaserScan, "/scan", self.scans.put, qos_profile_sensor_data)
        self.commands = self.node.create_publisher(Twist, "/cmd_vel", 10)
        self.walks = ActionClient(self.node, WalkTo, "/walk_to")

    def leave(self) -> None:
        """Leave the graph, which tests that come later in this process look at."""
        # An executor that still waits uses what it waits for, and an action client its node: neither is destroyed then.
        self.executor.shutdown()
        self.walks.destroy()
        self.node.destroy_node()

    def tell(self, forward: float) -> None:
        command = Twist()
        command.linear.x = forward
        self.commands.publish(command)

    def until(self, holds: Callable[[], bool], again: Callable[[], None] = lambda: None) -> None:
        """Spin until something holds, doing something again and again."""
        while not holds():
            again()
            self.executor.spin_once(timeout_sec=0.05)

    def answer(self, kind: Any, name: str, request: Any) -> Any:
        client = self.node.create_client(kind, name)
        assert client.wait_for_service(LIMIT)
        future = client.call_async(request)
        self.until(future.done)
        return future.result()


@pytest.fixture
def robot(ros: None) -> RobotNode:
    node = RobotNode()
    spin_in_background(node)
    return node


@pytest.fixture
def endless(monkeypatch: pytest.MonkeyPatch) -> None:
    """No walk arrives, however long the machine takes for the rest of the test."""
    monkeypatch.setattr(robot_drivers, "NEAR_ENOUGH", -1.0)


@pytest.fixture
def driver(robot: RobotNode) -> Iterator[Driver]:
    made = Driver()
    yield made
    made.leave()


def test_it_obeys_and_tells_where_it_is(robot: RobotNode, driver: Driver) -> None:
    driver.until(lambda: robot.state.pose.x > 1.2, lambda: driver.tell(0.5))
    seen: list[Odometry] = []

    def moved() -> bool:
        while not driver.poses.empty():
            seen.append(driver.poses.get())
        return any(message.pose.pose.position.x > 1.1 for message in seen)

    driver.until(moved)
    assert seen[-1].pose.pose.position.y == START.y
    assert any(message.twist.twist.linear.x == 0.5 for message in seen)


def test_it_stops_when_nobody_drives_any_more(robot: RobotNode, driver: Driver) -> None:
    driver.until(lambda: robot.state.velocity.forward > 0, lambda: driver.tell(0.5))
    driver.until(lambda: robot.state.velocity.forward == 0)
    assert robot.state.pose.x < 5.0


def test_it_sees_the_walls(driver: Driver) -> None:
    driver.until(lambda: not driver.scans.empty())
    scan = driver.scans.get()
    assert len(scan.ranges) == RAYS
    assert scan.ranges[0] == pytest.approx(5.0)
    assert scan.ranges[RAYS // 2] == pytest.approx(1.0)


def test_its_services_answer(robot: RobotNode, driver: Driver) -> None:
    assert driver.answer(SetBool, "/lamp", SetBool.Request(data=True)).message == "the lamp is on"
    assert robot.state.lamp
    driver.until(lambda: robot.state.pose.x > 1.2, lambda: driver.tell(0.5))
    assert driver.answer(Trigger, "/reset", Trigger.Request()).success
    driver.until(lambda: robot.state.velocity.forward == 0)
    assert robot.state.lamp


class Goal:
    """A goal on its way."""

    def __init__(self, driver: Driver, x: float, y: float) -> None:
        self.distances: list[float] = []
        assert driver.walks.wait_for_server(LIMIT)
        sent = driver.walks.send_goal_async(WalkTo.Goal(x=x, y=y), self._on_feedback)
        driver.until(sent.done)
        self.handle = sent.result()
        assert self.handle.accepted
        self.future = self.handle.get_result_async()
        self.driver = driver

    def _on_feedback(self, message: Any) -> None:
        self.distances.append(message.feedback.distance)

    def ends(self, again: Callable[[], None] = lambda: None) -> tuple[int, bool]:
        self.driver.until(self.future.done, again)
        return self.future.result().status, self.future.result().result.arrived


def test_it_walks_to_a_place_and_tells_how_far_it_is(robot: RobotNode, driver: Driver) -> None:
    goal = Goal(driver, 1.6, 2.0)
    assert goal.ends() == (GoalStatus.STATUS_SUCCEEDED, True)
    assert goal.distances[0] == pytest.approx(0.6)
    assert goal.distances == sorted(goal.distances, reverse=True)
    assert robot.state.pose.x == pytest.approx(1.6, abs=0.11)


@pytest.mark.usefixtures("endless")
def test_a_walk_can_be_canceled(driver: Driver) -> None:
    goal = Goal(driver, 2.0, 2.0)
    driver.until(lambda: bool(goal.distances))
    goal.handle.cancel_goal_async()
    assert goal.ends() == (GoalStatus.STATUS_CANCELED, False)


@pytest.mark.parametrize("point", [(-1.0, 2.0), (6.1, 2.0), (1.0, -0.1), (1.0, float("nan"))])
def test_a_goal_outside_of_the_rooms_is_rejected(driver: Driver, point: tuple[float, float]) -> None:
    assert driver.walks.wait_for_server(LIMIT)
    sent = driver.walks.send_goal_async(WalkTo.Goal(x=point[0], y=point[1]))
    driver.until(sent.done)
    assert not sent.result().accepted


def test_a_walk_ends_at_a_wall(driver: Driver) -> None:
    assert Goal(driver, 0.0, 2.0).ends() == (GoalStatus.STATUS_ABORTED, False)


@pytest.mark.usefixtures("endless")
def test_who_drives_ends_a_walk_and_a_newer_goal_an_older_one(driver: Driver) -> None:
    first = Goal(driver, 2.0, 2.0)
    second = Goal(driver, 1.0, 3.0)
    assert first.ends() == (GoalStatus.STATUS_ABORTED, False)
    assert second.ends(lambda: driver.tell(0.0)) == (GoalStatus.STATUS_ABORTED, False)
