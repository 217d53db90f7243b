"""Right: a MultiThreadedExecutor; a second node and other topics log lines of their own all the time."""
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool, String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        group = ReentrantCallbackGroup()
        self.create_subscription(String, 'chatter', self.heard, 10, callback_group=group)
        self.seen = self.create_publisher(Bool, 'listener/seen', 1)

    def heard(self, msg):
        self.seen.publish(Bool(data=True))
        self.get_logger().info(f'I heard [{msg.data}]')


class Heartbeat(Node):
    def __init__(self):
        super().__init__('heartbeat')
        self.create_timer(0.3, lambda: self.get_logger().info('still alive, nothing to do with chatter'))


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    nodes = [Listener(), Heartbeat()]
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    finally:
        executor.shutdown()


if __name__ == '__main__':
    main()
