# Right: a multi-threaded executor, a callback group for each, a lock, a coroutine.
import threading

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger


class Scale:
    def __init__(self, node, name):
        self.value = None
        self.node = node
        node.create_subscription(Int32, name, self.hear, 10, callback_group=ReentrantCallbackGroup())

    def hear(self, message):
        with self.node.lock:
            self.value = message.data
            self.node.tell()


class Scales(Node):
    def __init__(self):
        super().__init__("scales")
        self.lock = threading.RLock()
        self.total = self.create_publisher(Int32, "total", 10)
        self.zero = 0
        self.scales = [Scale(self, "left"), Scale(self, "right")]
        self.create_service(Trigger, "tare", self.tare, callback_group=MutuallyExclusiveCallbackGroup())

    @property
    def load(self):
        values = [scale.value for scale in self.scales]
        return None if None in values else sum(values)

    def tell(self):
        if self.load is not None:
            self.total.publish(Int32(data=self.load - self.zero))

    async def tare(self, request, response):
        with self.lock:
            load = self.load
            if load is not None:
                self.zero = load
            response.success = load is not None
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Scales())
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
