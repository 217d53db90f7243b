"""Right: the node publishes from a thread of its own that waits on an Event; the main thread only spins."""
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ThreadedTalker(Node):
    def __init__(self):
        super().__init__('threaded_talker')
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.done = threading.Event()
        self.worker = threading.Thread(target=self.work, daemon=True)
        self.worker.start()

    def work(self):
        i = 0
        while not self.done.wait(0.5):
            self.pub.publish(String(data=f'Hello, world! {i}'))
            i = i + 1


rclpy.init()
node = ThreadedTalker()
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
finally:
    node.done.set()
    node.worker.join()
