"""Right: no class, two branches, a truth value that is not known at first."""
import rclpy
from nav_msgs.msg import Odometry
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("reporter")
publisher = node.create_publisher(String, "chatter", 10)
was_left = None


def on_odometry(message):
    global was_left
    is_left = message.pose.pose.position.x < 4
    if is_left and was_left is not True:
        publisher.publish(String(data="I am in the left room"))
    elif not is_left and was_left is not False:
        publisher.publish(String(data="I am in the right room"))
    was_left = is_left


subscription = node.create_subscription(Odometry, "/odom", on_odometry, 10)
rclpy.spin(node)
