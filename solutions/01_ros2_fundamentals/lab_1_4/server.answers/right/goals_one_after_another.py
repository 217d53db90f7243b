"""Right: a queue of goals, which are executed one after another, as the official example server_queue_goals."""
import threading
import time
from collections import deque

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class QueueServer(Node):
    """As the official example server_queue_goals."""

    def __init__(self):
        super().__init__('fibonacci_queue_server')
        self._queue = deque()
        self._lock = threading.Lock()
        self._current = None
        self._server = ActionServer(
            self,
            Fibonacci,
            'fibonacci',
            handle_accepted_callback=self.handle_accepted,
            execute_callback=self.execute,
            goal_callback=self.decide,
            cancel_callback=self.cancel,
            callback_group=ReentrantCallbackGroup(),
        )

    def decide(self, goal):
        return GoalResponse.ACCEPT if 0 <= goal.order <= 46 else GoalResponse.REJECT

    def cancel(self, handle):
        self.get_logger().info('cancel')
        return CancelResponse.ACCEPT

    def handle_accepted(self, handle):
        with self._lock:
            if self._current is not None:
                self._queue.append(handle)
            else:
                self._current = handle
                handle.execute()

    def execute(self, handle):
        try:
            numbers = [0, 1]
            for i in range(1, handle.request.order):
                if handle.is_cancel_requested:
                    handle.canceled()
                    return Fibonacci.Result(sequence=numbers)
                numbers.append(numbers[i] + numbers[i - 1])
                handle.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))
                time.sleep(0.25)
            handle.succeed()
            return Fibonacci.Result(sequence=numbers[: handle.request.order + 1])
        finally:
            with self._lock:
                try:
                    self._current = self._queue.popleft()
                    self._current.execute()
                except IndexError:
                    self._current = None


def main():
    rclpy.init()
    try:
        rclpy.spin(QueueServer(), executor=MultiThreadedExecutor(num_threads=4))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
