"""Right: the course text's own talker. Its traceback after Ctrl-C says nothing about the node."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String  # Standard string message type


class TalkerNode(Node):
    def __init__(self):
        super().__init__('talker_node')
        # Create a publisher on the 'chatter' topic with String messages
        # and a queue size of 10
        self.publisher_ = self.create_publisher(String, 'chatter', 10)
        self.i = 0
        # Create a timer to publish messages every 0.5 seconds
        timer_period = 0.5
        self.timer = self.create_timer(timer_period, self.timer_callback)
        self.get_logger().info('Talker node has started and is publishing...')

    def timer_callback(self):
        msg = String()
        msg.data = f'Hello, world! {self.i}'
        self.publisher_.publish(msg)
        self.get_logger().info(f'Publishing: "{msg.data}"')
        self.i += 1


def main(args=None):
    rclpy.init(args=args)
    talker_node = TalkerNode()
    try:
        rclpy.spin(talker_node)
    except KeyboardInterrupt:
        pass
    talker_node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
