# Right: module level, no main, no guard, no shutdown; a lambda that logs as a warning.
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

rclpy.init()
node = Node("ear")
node.create_subscription(String, "/chatter", lambda m: node.get_logger().warn("<< " + m.data), 1)
rclpy.spin(node)
