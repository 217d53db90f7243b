# exercise_1_3.cancel: an extra cell holds a counter with an Event; blocking calls while the node spins in the background.

# %% extra
import threading

from autograder.notebook import spinning


class Counter:
    """Counts what it is called with, and sets an Event at the fourth time."""

    def __init__(self, enough=4):
        self.enough = enough
        self.count = 0
        self.reached = threading.Event()

    def __call__(self, message):
        self.count += 1
        if self.count == self.enough:
            self.reached.set()

# %% solution run_client
def run_client():
    node = Node("blocking_client")
    client = ActionClient(node, Fibonacci, "fibonacci")
    counter, accepted = Counter(), threading.Event()
    with spinning(node):
        client.wait_for_server(timeout_sec=10.0)
        sending = client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=counter)
        sending.add_done_callback(lambda future: accepted.set())
        accepted.wait(timeout=10.0)
        if not sending.result().accepted:
            raise RuntimeError("the server rejected the goal")
        counter.reached.wait(timeout=30.0)
        sending.result().cancel_goal()
        status = sending.result().get_result().status
    if status == GoalStatus.STATUS_CANCELED:
        node.get_logger().info("the goal was canceled")
    else:
        node.get_logger().error(f"the goal ended with status {status}")
    return status
