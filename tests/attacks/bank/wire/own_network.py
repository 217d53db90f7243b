# family = "wire"
# assignment = "lab_1_3"
# tries = "Client and server of the attacker's own talk to each other on the judge's domain, under the right names, while the judge watches; the subject itself does nothing."
# could_earn = "The client's points for calls that the judge's server should have been asked."
# undefended = "Only what the judge's own server was asked counts."

# %% solution add_two_ints
def add_two_ints(a, b, patience_sec=5.0):
    node = rclpy.create_node("both")
    node.create_service(
        AddTwoInts, "add_two", lambda request, response: setattr(response, "sum", request.a + request.b) or response
    )
    client = node.create_client(AddTwoInts, "add_two")
    client.wait_for_service(timeout_sec=1.0)
    future = client.call_async(AddTwoInts.Request(a=a, b=b))
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
    print("the service answered", future.result().sum)
    return future.result().sum
