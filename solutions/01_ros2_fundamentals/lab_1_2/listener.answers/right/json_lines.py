"""Right: each line is JSON, which escapes letters beyond ASCII; the line at the start has the same keys."""
import json

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.create_subscription(String, 'chatter', lambda msg: self.write(msg.data), 10)
        self.write('started')

    def write(self, text):
        print(json.dumps({'node': self.get_name(), 'message': text}), flush=True)


def main():
    rclpy.init()
    rclpy.spin(Listener())


if __name__ == '__main__':
    main()
