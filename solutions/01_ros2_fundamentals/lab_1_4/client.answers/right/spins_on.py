"""Right: reports everything and goes on spinning."""
import sys

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient


def main():
    rclpy.init()
    node = rclpy.create_node('patient')
    client = ActionClient(node, Fibonacci, 'fibonacci')

    def done(future):
        answer = future.result()
        print('status', answer.status, 'numbers', ' '.join(map(str, answer.result.sequence)))

    def answered(future):
        if future.result().accepted:
            future.result().get_result_async().add_done_callback(done)
        else:
            print('rejected: order', sys.argv[1])

    if not client.wait_for_server(timeout_sec=6.0):
        print('action server not available, giving up', file=sys.stderr)
        return
    goal = Fibonacci.Goal()
    goal.order = int(sys.argv[1])
    client.send_goal_async(goal, feedback_callback=lambda m: print(m.feedback)).add_done_callback(answered)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
