"""Wrong: the stub as it was handed out."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class TalkerNode(Node):
    def __init__(self):
        super().__init__('talker_node')
        # TODO: create a publisher on 'chatter' and a timer of 0.5 s


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TalkerNode())


if __name__ == '__main__':
    main()
