"""Right: takes the messages of its one subscription by hand, and nothing spins the node."""
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('by_hand')
subscription = node.create_subscription(String, 'chatter', lambda message: None, 10)
while rclpy.ok():
    with subscription.handle:
        taken = subscription.handle.take_message(String, False)
    if taken is None:
        time.sleep(0.01)
    else:
        print('heard', taken[0].data, flush=True)
