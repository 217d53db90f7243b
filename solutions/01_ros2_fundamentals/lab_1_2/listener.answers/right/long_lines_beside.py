"""Right: prints a line of half a megabyte beside each text."""
import rclpy
from std_msgs.msg import String


def heard(msg):
    print('.' * 500_000, flush=True)
    print('I heard:', msg.data, flush=True)


rclpy.init()
node = rclpy.create_node('listener')
node.create_subscription(String, 'chatter', heard, 10)
rclpy.spin(node)
