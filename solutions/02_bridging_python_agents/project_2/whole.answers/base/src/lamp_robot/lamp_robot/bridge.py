import math
from dataclasses import dataclass

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_srvs.srv import Trigger


@dataclass(frozen=True)
class Observation:
    x: float
    y: float
    heading: float
    lamp: tuple[float, float] | None = None


@dataclass(frozen=True)
class Command:
    forward: float = 0.0
    turn: float = 0.0


def distance(seen, point):
    return math.dist((seen.x, seen.y), point)


def towards(seen, point):
    off = math.atan2(point[1] - seen.y, point[0] - seen.x) - seen.heading
    off = math.remainder(off, math.tau)
    return Command(turn=math.copysign(1.0, off)) if abs(off) > 0.3 else Command(1.0, off)


class Finder:
    def __init__(self):
        self.phase = "search"
        self.home = None

    def decide(self, seen):
        self.look(seen)
        if self.phase == "go":
            return towards(seen, seen.lamp)
        if self.phase == "back":
            return towards(seen, self.home)
        return Command()

    def look(self, seen):
        if self.home is None:
            self.home = (seen.x, seen.y)
        if self.phase == "search" and seen.lamp:
            self.phase = "go"
        elif self.phase == "go" and distance(seen, seen.lamp) < 0.3:
            self.phase = "back"
        elif self.phase == "back" and distance(seen, self.home) < 0.3:
            self.phase = "done"


class Bridge(Node):
    def __init__(self):
        super().__init__("bridge")
        self.agent = Finder()
        self.lamp = None
        self.odom = None
        self.came_at = None
        self.command = self.create_publisher(Twist, "agent_vel", 10)
        self.where = self.create_client(Trigger, "where")
        self.create_subscription(Odometry, "odom", self.on_odom, 10)
        self.create_timer(2.0, self.ask)
        self.create_timer(0.2, self.act)

    def on_odom(self, odom):
        self.odom = odom
        self.came_at = self.get_clock().now()

    def ask(self):
        if self.lamp is None:
            self.where.call_async(Trigger.Request()).add_done_callback(self.on_answer)

    def on_answer(self, future):
        x, y = future.result().message.split()
        self.lamp = (float(x), float(y))

    def observation(self):
        pose = self.odom.pose.pose
        heading = 2 * math.atan2(pose.orientation.z, pose.orientation.w)
        return Observation(pose.position.x, pose.position.y, heading, self.lamp)

    def act(self):
        command = Command()
        if self.came_at and self.get_clock().now() - self.came_at < Duration(seconds=1):
            command = self.agent.decide(self.observation())
        twist = Twist()
        twist.linear.x, twist.angular.z = command.forward, command.turn
        self.command.publish(twist)


def main():
    rclpy.init()
    node = Bridge()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
