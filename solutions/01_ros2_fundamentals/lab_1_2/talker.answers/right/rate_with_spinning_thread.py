"""Right: create_rate(2) in the main thread while a second thread spins."""
import threading

import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node('rated')
    pub = node.create_publisher(String, 'chatter', 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    rate = node.create_rate(2)
    i = 0
    try:
        while rclpy.ok():
            rate.sleep()
            pub.publish(String(data=f'Hello, world! {i}'))
            node.get_logger().info(f'{i} is out')
            i += 1
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
