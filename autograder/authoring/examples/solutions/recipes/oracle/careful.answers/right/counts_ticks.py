"""Right: counts its own ticks since the last scan; the subscription has the QoS of a sensor."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

SPEEDS = {"driving": (0.2, 0.0), "turning": (0.0, 0.5), "blind": (0.0, 0.0)}


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.is_turning = False
        self.ticks = 99
        self.twist = self.create_publisher(Twist, "/cmd_vel", 5)
        self.tells = self.create_publisher(String, "/state", 5)
        self.create_subscription(LaserScan, "/scan", self.on_scan, qos_profile_sensor_data)
        self.create_timer(0.2, self.tick)

    def on_scan(self, scan):
        self.ticks = 0
        limit = 0.8 if self.is_turning else 0.5
        nearest = min(scan.ranges[3], scan.ranges[4], scan.ranges[5])
        self.is_turning = nearest <= limit if self.is_turning else nearest < limit

    def tick(self):
        self.ticks += 1
        state = "blind" if self.ticks > 5 else "turning" if self.is_turning else "driving"
        command = Twist()
        command.linear.x, command.angular.z = SPEEDS[state]
        self.twist.publish(command)
        self.tells.publish(String(data=state))


rclpy.init()
node = Robot()
while rclpy.ok():
    rclpy.spin_once(node)
