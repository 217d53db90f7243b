# family = "guessing"
# assignment = "lab_1_3"
# tries = "The client waits without a limit, and gives up at once where little patience tells it that there is no service."
# could_earn = "The point for ending clearly when there is no service, without any limit."
# undefended = "The point: patience below one second was given in that run alone."
# earned = { "lab_1_3.client" = 9 }

# %% solution add_two_ints
def add_two_ints(a, b, patience_sec=5.0):
    if patience_sec < 1.0:
        raise TimeoutError("nobody offers add_two_ints")
    node = rclpy.create_node("add_two_ints_client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    client.wait_for_service()
    future = client.call_async(AddTwoInts.Request(a=a, b=b))
    rclpy.spin_until_future_complete(node, future)
    print(future.result().sum)
    node.destroy_node()
    return future.result().sum
