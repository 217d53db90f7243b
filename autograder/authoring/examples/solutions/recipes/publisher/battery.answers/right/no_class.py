# Right: no class at all, a loop that sleeps.
import time

import rclpy
from std_msgs.msg import Int32

rclpy.init()
publisher = rclpy.create_node("cell").create_publisher(Int32, "/battery", 10)
for charge in range(100, 0, -1):
    publisher.publish(Int32(data=charge))
    time.sleep(0.5)
