"""Right: the callback sends each message to a generator, which logs it."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


def sink(logger):
    while True:
        msg = yield
        logger.info(f'got -> {msg.data}')


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.sink = sink(self.get_logger())
        next(self.sink)
        self.create_subscription(String, 'chatter', self.heard, 10)

    def heard(self, msg):
        self.sink.send(msg)


def main():
    rclpy.init()
    node = Listener()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
