"""Wrong, row 35: rate.sleep() waits for a timer that nobody spins; the first text is the last."""
import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node('rated')
    pub = node.create_publisher(String, 'chatter', 10)
    rate = node.create_rate(2)
    i = 0
    while rclpy.ok():
        pub.publish(String(data=f'Hello, world! {i}'))
        i += 1
        rate.sleep()


if __name__ == '__main__':
    main()
