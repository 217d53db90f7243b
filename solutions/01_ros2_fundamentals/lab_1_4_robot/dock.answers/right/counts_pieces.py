# Right: a for loop over the pieces, the distance calculated anew, another order in each round.
import time

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.action import ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo

PIECE = 0.25


class ChargingStation(Node):
    def __init__(self):
        super().__init__("charging_station")
        self.scan = None
        self.create_subscription(LaserScan, "/scan", self.keep, 1)
        self.wheels = self.create_publisher(Twist, "/cmd_vel", 1)
        self.server = ActionServer(self, WalkTo, "/dock", self.drive)

    def keep(self, scan):
        self.scan = scan

    def drive(self, handle):
        way = handle.request.x
        result = WalkTo.Result()
        if self.scan is None or self.scan.ranges[0] < way:
            handle.abort()
            return result
        pieces = round(way / PIECE)
        for done in range(1, pieces + 1):
            handle.publish_feedback(WalkTo.Feedback(distance=way - done * PIECE))
            self.wheels.publish(Twist(linear=Vector3(x=0.5)))
            time.sleep(0.1)
        handle.succeed()
        self.wheels.publish(Twist())
        result.arrived = True
        return result


rclpy.init()
rclpy.spin(ChargingStation(), MultiThreadedExecutor(num_threads=4))
