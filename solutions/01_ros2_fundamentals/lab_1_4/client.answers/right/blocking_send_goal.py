"""Right: the blocking send_goal() in a second thread, whose status 0 is that of a refused goal."""
import sys
import threading

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class Caller(Node):
    def __init__(self):
        super().__init__('caller')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')

    def show(self, message):
        self.get_logger().info(f'so far {message.feedback.partial_sequence.tolist()}')

    def run(self, order):
        if not self.client.wait_for_server(timeout_sec=5.0):
            self.get_logger().error('fibonacci is not available')
            return
        answer = self.client.send_goal(Fibonacci.Goal(order=order), feedback_callback=self.show)
        if answer.status == 0:
            self.get_logger().error('the server REJECTED the goal')
        elif answer.status == 4:
            self.get_logger().info(f'done: {answer.result.sequence.tolist()}')
        else:
            self.get_logger().error(f'it went wrong, status {answer.status}')


def main():
    rclpy.init()
    node = Caller()
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    work = threading.Thread(target=node.run, args=(int(sys.argv[1]),))
    work.start()
    while work.is_alive():
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
