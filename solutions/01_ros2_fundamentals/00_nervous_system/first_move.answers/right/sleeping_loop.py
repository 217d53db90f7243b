# Right: no class at all, a loop that sleeps.
import time

import rclpy
from geometry_msgs.msg import Twist, Vector3

rclpy.init()
publisher = rclpy.create_node("fahrer").create_publisher(Twist, "cmd_vel", 10)
while rclpy.ok():
    publisher.publish(Twist(linear=Vector3(x=0.5)))
    time.sleep(0.5)
