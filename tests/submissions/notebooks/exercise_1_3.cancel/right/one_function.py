# exercise_1_3.cancel: one function with closures and spin_once, cancels at the fifth feedback, returns the status's number.

# %% solution run_client
def run_client():
    node = rclpy.create_node("one_function")
    client = ActionClient(node, Fibonacci, "fibonacci")
    feedbacks = []
    try:
        if not client.wait_for_server(timeout_sec=10.0):
            print("no action server")
            return None
        sending = client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=feedbacks.append)
        rclpy.spin_until_future_complete(node, sending)
        goal = sending.result()
        if not goal.accepted:
            print("the goal was rejected")
            return None
        while len(feedbacks) < 5:
            rclpy.spin_once(node, timeout_sec=0.1)
        goal.cancel_goal_async()
        result = goal.get_result_async()
        rclpy.spin_until_future_complete(node, result)
        print("status:", result.result().status)
        return result.result().status
    finally:
        client.destroy()
        node.destroy_node()
