# Right: a loop of spin_once with a timeout, and Python's own clock.
import time

import rclpy
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Empty, String

rclpy.init()
node = rclpy.create_node("watchdog")
alarm = node.create_publisher(String, "alarm", 10)
beats = []
node.create_subscription(Empty, "heartbeat", lambda message: beats.append(time.monotonic()), qos_profile_sensor_data)
state = "back"
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0.05)
    if not beats:
        continue
    now = "lost" if time.monotonic() - beats[-1] > 1.0 else "back"
    if now != state:
        alarm.publish(String(data=now))
        state = now
