"""Right: a second thread spins; the main thread waits on an Event that the fourth feedback sets; blocking calls."""
import threading

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor


def main():
    rclpy.init()
    node = rclpy.create_node('event_client')
    client = ActionClient(node, Fibonacci, 'fibonacci')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    spinner = threading.Thread(target=executor.spin, daemon=True)
    spinner.start()

    enough = threading.Event()
    accepted = threading.Event()
    seen = []

    def feedback(message):
        seen.append(message)
        if len(seen) >= 4:
            enough.set()

    if not client.wait_for_server(timeout_sec=10.0):
        raise SystemExit('/fibonacci is not available')
    future = client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=feedback)
    future.add_done_callback(lambda _: accepted.set())
    accepted.wait()
    goal = future.result()
    if not goal.accepted:
        raise SystemExit('the goal was rejected')
    enough.wait()
    goal.cancel_goal()
    print('status', goal.get_result().status)

    executor.shutdown()
    spinner.join()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
