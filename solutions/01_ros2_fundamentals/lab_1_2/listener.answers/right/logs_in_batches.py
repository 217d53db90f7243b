"""Right: collects what it hears and a timer logs it a little later, several texts in one line."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class BatchListener(Node):
    def __init__(self):
        super().__init__('batch_listener')
        self.batch = []
        self.create_subscription(String, 'chatter', lambda msg: self.batch.append(msg.data), 10)
        self.create_timer(0.25, self.flush)

    def flush(self):
        if self.batch:
            self.get_logger().info('Heard: ' + ' | '.join(self.batch))
            self.batch.clear()


def main():
    rclpy.init()
    rclpy.spin(BatchListener())


if __name__ == '__main__':
    main()
