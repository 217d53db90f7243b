"""Wrong: a loop that publishes two messages and sleeps for a second."""
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('talker')
publisher = node.create_publisher(String, 'chatter', 10)
i = 0
while rclpy.ok():
    for _ in range(2):
        publisher.publish(String(data=f'Hello, world! {i}'))
        i += 1
    time.sleep(1.0)
