# Right: what the notebook asks for, with the agent that explores.
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


def observe(scan):
    ahead = [*scan.ranges[-3:], *scan.ranges[:4]]
    return min(ahead), min(scan.ranges[7:12]), min(scan.ranges[25:30])


class Explorer:
    def __init__(self):
        self.turn = 0.0

    def decide(self, seen):
        ahead, left, right = seen
        if self.turn and ahead > 1.0:
            self.turn = 0.0
        elif not self.turn and ahead < 0.6:
            self.turn = 1.0 if left > right else -1.0
        return (0.0, self.turn) if self.turn else (0.4, 0.0)


class Bridge(Node):
    def __init__(self):
        super().__init__("bridge")
        self.agent = Explorer()
        self.scan = None
        self.create_subscription(LaserScan, "scan", self.sense, 10)
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(0.2, self.act)

    def sense(self, scan):
        self.scan = scan

    def act(self):
        if self.scan is not None:
            command = self.agent.decide(observe(self.scan))
            twist = Twist()
            twist.linear.x, twist.angular.z = command
            self.publisher.publish(twist)


rclpy.init()
rclpy.spin(Bridge())
