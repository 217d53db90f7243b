"""Right: a thread that sleeps until the next moment of its own plan."""
import threading
import time

import rclpy
from std_msgs.msg import String


def talk(publisher):
    start = time.monotonic()
    for i in range(1000):
        publisher.publish(String(data=f'Hello, world! {i}'))
        time.sleep(max(0.0, start + 0.5 * (i + 1) - time.monotonic()))


rclpy.init()
node = rclpy.create_node('talker')
threading.Thread(target=talk, args=(node.create_publisher(String, 'chatter', 10),), daemon=True).start()
rclpy.spin(node)
