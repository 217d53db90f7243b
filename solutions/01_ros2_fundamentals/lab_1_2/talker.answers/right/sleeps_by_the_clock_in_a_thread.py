"""Right: a thread sleeps by the node's clock, and does some work between two messages."""
import threading
import time

import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String


def talk(node, publisher):
    i = 0
    while rclpy.ok():
        publisher.publish(String(data=f'Hello, world! {i}'))
        i += 1
        time.sleep(0.002)
        node.get_clock().sleep_for(Duration(seconds=0.5))


rclpy.init()
node = rclpy.create_node('talker')
threading.Thread(target=talk, args=(node, node.create_publisher(String, 'chatter', 10)), daemon=True).start()
rclpy.spin(node)
