# Right: nothing has to be spun, since no callback is needed.
import time

import rclpy
from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy, QoSProfile
from std_msgs.msg import String

rclpy.init()
qos = QoSProfile(history=QoSHistoryPolicy.KEEP_ALL, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
publisher = rclpy.create_node("maps").create_publisher(String, "/map_name", qos)
publisher.publish(String(data="kitchen"))
while rclpy.ok():
    time.sleep(0.1)
