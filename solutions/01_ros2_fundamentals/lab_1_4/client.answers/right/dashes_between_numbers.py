"""Right: the numbers of a sequence are joined by dashes."""
import sys

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient

NAMES = {4: 'SUCCEEDED', 5: 'CANCELED', 6: 'ABORTED'}


def text(numbers):
    return '-'.join(str(number) for number in numbers)


def main():
    rclpy.init()
    node = rclpy.create_node('dashes')
    client = ActionClient(node, Fibonacci, 'fibonacci')
    if not client.wait_for_server(timeout_sec=5.0):
        sys.exit('no action server: fibonacci not available')
    sent = client.send_goal_async(
        Fibonacci.Goal(order=int(sys.argv[1])), lambda m: print('so far:', text(m.feedback.partial_sequence))
    )
    rclpy.spin_until_future_complete(node, sent, timeout_sec=5.0)
    if not sent.done():
        sys.exit('no answer to the goal')
    if not sent.result().accepted:
        print('REJECTED')
        return
    ended = sent.result().get_result_async()
    rclpy.spin_until_future_complete(node, ended, timeout_sec=60.0)
    if not ended.done():
        sys.exit('no result')
    print(NAMES[ended.result().status], text(ended.result().result.sequence))


if __name__ == '__main__':
    main()
