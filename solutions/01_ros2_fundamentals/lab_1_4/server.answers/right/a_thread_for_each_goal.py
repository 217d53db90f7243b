"""Right: each accepted goal gets a thread of its own."""
import threading
import time
import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Server(Node):
    def __init__(self):
        super().__init__('server')
        self.server = ActionServer(self, Fibonacci, 'fibonacci', execute_callback=self.execute, goal_callback=self.on_goal, cancel_callback=self.on_cancel, handle_accepted_callback=lambda handle: threading.Thread(target=handle.execute, daemon=True).start())

    def on_goal(self, goal):
        return GoalResponse.ACCEPT if 0 <= goal.order <= 46 else GoalResponse.REJECT

    def on_cancel(self, handle):
        return CancelResponse.ACCEPT

    def execute(self, handle):
        numbers = [0, 1]
        while len(numbers) <= handle.request.order:
            if handle.is_cancel_requested:
                handle.canceled()
                return Fibonacci.Result(sequence=numbers)
            numbers.append(numbers[-2] + numbers[-1])
            handle.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))
            time.sleep(0.1)
        handle.succeed()
        return Fibonacci.Result(sequence=numbers[:handle.request.order + 1])


def main():
    rclpy.init()
    rclpy.spin(Server(), executor=MultiThreadedExecutor(4))


if __name__ == '__main__':
    main()
