"""Right: the period 1.0/2.0 and the topic come from parameters with defaults."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ParametrizedTalker(Node):
    def __init__(self):
        super().__init__('parametrized_talker')
        period = self.declare_parameter('period', 1.0 / 2.0).value
        topic = self.declare_parameter('topic', 'chatter').get_parameter_value().string_value
        self.pub = self.create_publisher(String, topic, 10)
        self.count = 0
        self.timer = self.create_timer(period, self.tick)
        self.get_logger().info(f'{topic=} {period=}')

    def tick(self):
        self.pub.publish(String(data=f'Hello, world! {self.count}'))
        self.count += 1


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(ParametrizedTalker())
    rclpy.shutdown()


if __name__ == '__main__':
    main()
