"""Wrong: main() is there, but nothing calls it."""
import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node('talker_node')
    pub = node.create_publisher(String, 'chatter', 10)
    i = 0

    def tick():
        nonlocal i
        pub.publish(String(data=f'Hello, world! {i}'))
        i += 1

    node.create_timer(0.5, tick)
    rclpy.spin(node)
