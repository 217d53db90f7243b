"""Wrong: the stub as it was handed out."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        # TODO: subscribe to 'chatter'

    def listener_callback(self, msg):
        # TODO: log what was heard
        pass


def main(args=None):
    rclpy.init(args=args)
    node = ListenerNode()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
