# exercise_1_3.cancel: reads the sequence from the feedback message as the course text does; the first feedback raises.

# %% solution CancelingClient
class CancelingClient(Node):
    def __init__(self) -> None:
        super().__init__("fibonacci_client")
        self.fibonacci = ActionClient(self, Fibonacci, "fibonacci")
        self.goal_handle = None
        self.feedback_count = 0

    def on_feedback(self, message):
        self.feedback_count += 1
        self.get_logger().info(f"feedback: {list(message.partial_sequence)}")
        if self.feedback_count == 3:
            self.goal_handle.cancel_goal_async()

# %% extra
def send_goal(client, order):
    if not client.fibonacci.wait_for_server(timeout_sec=5.0):
        raise TimeoutError("action server not available")
    future = client.fibonacci.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=client.on_feedback)
    client.goal_handle = wait_for(client, future, 5.0)

# %% solution run_client
def run_client():
    client = CancelingClient()
    try:
        send_goal(client, order=20)
        answer = wait_for(client, client.goal_handle.get_result_async(), 30.0)
        client.get_logger().info(f"final status: {answer.status}")
    finally:
        client.destroy_node()
