"""Right: no class at all, create_node and a nested callback; str.format."""
import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node('minimal')
    publisher = node.create_publisher(String, '/chatter', 1)
    number = 0

    def tick():
        nonlocal number
        publisher.publish(String(data='Hello, world! {}'.format(number)))
        number += 1

    node.create_timer(1 / 2, tick)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
