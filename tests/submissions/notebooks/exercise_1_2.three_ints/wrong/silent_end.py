# exercise_1_2.three_ints: partly right; when the service is missing it returns None without a word.

# %% extra
def ask(node, client, a, b, patience_sec):
    future = client.call_async(AddTwoInts.Request(a=a, b=b))
    rclpy.spin_until_future_complete(node, future, timeout_sec=patience_sec)
    return future.result().sum

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    node = rclpy.create_node("add_three_ints_client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    total = None
    if client.wait_for_service(timeout_sec=patience_sec):
        total = ask(node, client, ask(node, client, a, b, patience_sec), c, patience_sec)
        node.get_logger().info(f"Final sum: {total}")
    node.destroy_node()
    return total
