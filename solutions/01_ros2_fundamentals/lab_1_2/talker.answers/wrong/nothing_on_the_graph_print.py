"""Wrong: no ROS at all, just the right words on the screen."""
import time


class TalkerNode:
    def __init__(self):
        self.i = 0

    def timer_callback(self):
        print(f'Publishing: "Hello, world! {self.i}"')
        self.i += 1


def main(args=None):
    node = TalkerNode()
    while True:
        node.timer_callback()
        time.sleep(0.5)


if __name__ == '__main__':
    main()
