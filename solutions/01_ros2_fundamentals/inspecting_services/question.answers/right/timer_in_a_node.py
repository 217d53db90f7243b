"""Right: a class whose timer looks, spun until it has found or given up; the name is logged without its slash."""
import sys

import rclpy
from rclpy.node import Node


class Finder(Node):
    def __init__(self, wanted):
        super().__init__('finder')
        self.wanted = wanted
        self.ticks = 0
        self.done = False
        self.create_timer(0.1, self.look)

    def look(self):
        self.ticks += 1
        for name, types in self.get_service_names_and_types():
            if types[0] == self.wanted:
                self.get_logger().info('Found: %s' % name.lstrip('/'))
                self.done = True
                return
        if self.ticks > 45:
            self.get_logger().error('gave up: not available')
            self.done = True


def main():
    rclpy.init()
    finder = Finder(sys.argv[1])
    while rclpy.ok() and not finder.done:
        rclpy.spin_once(finder, timeout_sec=0.5)
    finder.destroy_node()
    rclpy.shutdown()


main()
