"""Right: its name stands before each line, also before the one that tells what it waits for."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.create_subscription(String, 'chatter', self.callback, 10)
        print('[listener] ready, waiting for messages', flush=True)

    def callback(self, msg):
        print(f'[listener] {msg.data}', flush=True)


def main():
    rclpy.init()
    rclpy.spin(Listener())


if __name__ == '__main__':
    main()
