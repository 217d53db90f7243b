"""Wrong: wait_for_message in a loop makes a new subscription each time, and what comes in between is lost."""
import rclpy
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('l')
while rclpy.ok():
    ok, msg = wait_for_message(String, node, 'chatter')
    if ok:
        print('heard', msg.data, flush=True)
