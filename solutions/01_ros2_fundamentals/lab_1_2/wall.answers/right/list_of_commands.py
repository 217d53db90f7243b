"""Right: the speed from a table, a lambda, and a node that is made in a function."""
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

SPEED = {True: 0.5, False: 0.0}


def made() -> Node:
    node = Node("driver")
    wheels = node.create_publisher(Twist, "/cmd_vel", 5)
    node.create_subscription(
        LaserScan,
        "/scan",
        lambda scan: wheels.publish(Twist(linear=Vector3(x=SPEED[scan.ranges[0] > 0.8]))),
        5,
    )
    return node


rclpy.init()
rclpy.spin(made())
