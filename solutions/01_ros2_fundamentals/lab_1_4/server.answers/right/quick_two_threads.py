"""Right: a tenth of a second for each number, two threads, a generator."""
import time

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

LARGEST = 46


def growing(order: int):
    numbers = [0, 1]
    for _ in range(order - 1):
        numbers = [*numbers, numbers[-1] + numbers[-2]]
        yield numbers


class Server(Node):
    def __init__(self, **kwargs):
        super().__init__('server', **kwargs)
        self.action = ActionServer(self, Fibonacci, 'fibonacci', self.run)
        self.action.register_goal_callback(self.accepts)
        self.action.register_cancel_callback(lambda _: CancelResponse.ACCEPT)

    def accepts(self, goal: Fibonacci.Goal) -> GoalResponse:
        return GoalResponse.REJECT if goal.order < 0 or goal.order > LARGEST else GoalResponse.ACCEPT

    def run(self, handle: ServerGoalHandle) -> Fibonacci.Result:
        numbers = [0, 1][: handle.request.order + 1]
        for numbers in growing(handle.request.order):
            handle.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))
            time.sleep(0.1)
            if handle.is_cancel_requested:
                handle.canceled()
                break
        else:
            handle.succeed()
        return Fibonacci.Result(sequence=numbers)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Server())
    executor.spin()


if __name__ == '__main__':
    main()
