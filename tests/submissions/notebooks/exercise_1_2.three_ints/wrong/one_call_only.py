# exercise_1_2.three_ints: one call, the rest is added in Python.

# %% extra
def ask(node, client, a, b, patience_sec):
    future = client.call_async(AddTwoInts.Request(a=a, b=b))
    rclpy.spin_until_future_complete(node, future, timeout_sec=patience_sec)
    return future.result().sum

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    node = rclpy.create_node("add_three_ints_client")
    try:
        client = node.create_client(AddTwoInts, "add_two_ints")
        if not client.wait_for_service(timeout_sec=patience_sec):
            raise TimeoutError("service not available")
        return ask(node, client, a, b, patience_sec) + c
    finally:
        node.destroy_node()
