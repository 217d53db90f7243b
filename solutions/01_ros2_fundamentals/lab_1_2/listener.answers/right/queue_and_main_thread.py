"""Right: a daemon thread spins and fills a queue, the main thread prints what it takes out."""
import queue
import threading

import rclpy
from std_msgs.msg import String

texts = queue.Queue()


def main():
    rclpy.init()
    node = rclpy.create_node('queued')
    node.create_subscription(String, 'chatter', lambda msg: texts.put(msg.data), 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    while True:
        text = texts.get()
        print('>', text, '<', sep='')


if __name__ == '__main__':
    try:
        main()
    except KeyboardInterrupt:
        print('bye')
