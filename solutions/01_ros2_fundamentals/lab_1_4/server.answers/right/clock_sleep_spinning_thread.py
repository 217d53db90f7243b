"""Right: paces by the node's clock; a thread spins; another action beside it."""
import threading

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor


def main():
    rclpy.init()
    node = rclpy.create_node('fib', namespace='robot')

    def execute(goal_handle):
        clock = node.get_clock()
        sequence = [0, 1]
        while len(sequence) < goal_handle.request.order + 1:
            clock.sleep_for(Duration(seconds=0.25))
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sequence[-2] + sequence[-1])
            goal_handle.publish_feedback(Fibonacci.Feedback(partial_sequence=sequence))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=sequence)

    def check(goal):
        return GoalResponse.REJECT if not 0 <= goal.order < 47 else GoalResponse.ACCEPT

    for name in ('/fibonacci', 'another'):
        ActionServer(
            node, Fibonacci, name, execute, goal_callback=check,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
    executor = MultiThreadedExecutor(num_threads=5)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    thread.join()


if __name__ == '__main__':
    main()
