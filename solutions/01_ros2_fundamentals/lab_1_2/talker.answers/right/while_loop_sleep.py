"""Right: a while loop with time.sleep, nothing spins (publishing needs no spin); the first text goes out at once."""
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('looper')
pub = node.create_publisher(String, 'chatter', 10)
i = 0
while rclpy.ok():
    msg = String()
    msg.data = 'Hello, world! ' + str(i)
    pub.publish(msg)
    print('Publishing:', msg.data)
    i += 1
    time.sleep(0.5)
