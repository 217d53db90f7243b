"""Right: the loop sleeps on the node's clock, which a second thread keeps up to date; ends after 100 texts."""
from threading import Thread

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import String


def talk(node: Node, texts: int) -> None:
    publisher = node.create_publisher(String, 'chatter', 10)
    pause = Duration(seconds=0.5)
    for number in range(texts):
        node.get_clock().sleep_for(pause)
        publisher.publish(String(data=f'Hello, world! {number}'))


def main() -> None:
    rclpy.init()
    node = Node('sleeper')
    Thread(target=rclpy.spin, args=[node], daemon=True).start()
    talk(node, texts=100)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
