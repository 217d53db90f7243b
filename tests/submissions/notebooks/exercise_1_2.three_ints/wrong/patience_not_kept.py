# exercise_1_2.three_ints: partly right; it waits five seconds for the service, whatever it is told.

# %% extra
def ask(node: Node, client: Client, a: int, b: int, patience_sec: float) -> int:
    request = AddTwoInts.Request()
    request.a = a
    request.b = b
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=patience_sec)
    if not future.done():
        raise TimeoutError("no answer")
    return future.result().sum

# %% solution add_three_ints
def add_three_ints(a: int, b: int, c: int, patience_sec: float = 5.0) -> int:
    node = rclpy.create_node("add_three_ints_client")
    try:
        client = node.create_client(AddTwoInts, "add_two_ints")
        if not client.wait_for_service(timeout_sec=5.0):
            raise TimeoutError("add_two_ints is not available")
        total = ask(node, client, ask(node, client, a, b, patience_sec), c, patience_sec)
        node.get_logger().info(f"the sum is {total}")
        return total
    finally:
        node.destroy_node()
