"""Right: a dataclass keeps the tally; cancels at the fifth feedback; argparse with defaults; the status by its number."""
import argparse
from dataclasses import dataclass, field

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.task import Future


@dataclass
class Tally:
    limit: int
    count: int = 0
    full: Future = field(default_factory=Future)

    def __call__(self, message) -> None:
        self.count += 1
        if self.count == self.limit:
            self.full.set_result(None)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument('--order', type=int, default=20)
    parser.add_argument('--after', type=int, default=5)
    options = parser.parse_args()

    rclpy.init()
    node = rclpy.create_node('tally')
    client = ActionClient(node, Fibonacci, 'fibonacci')
    if not client.wait_for_server(timeout_sec=10.0):
        raise SystemExit('fibonacci is not available')
    tally = Tally(options.after)
    sending = client.send_goal_async(Fibonacci.Goal(order=options.order), feedback_callback=tally)
    rclpy.spin_until_future_complete(node, sending)
    if not sending.result().accepted:
        raise SystemExit('fibonacci rejected the goal')
    result = sending.result().get_result_async()
    rclpy.spin_until_future_complete(node, tally.full)
    sending.result().cancel_goal_async()
    rclpy.spin_until_future_complete(node, result)
    print(f'after {tally.count} feedbacks: status {result.result().status}')


if __name__ == '__main__':
    main()
