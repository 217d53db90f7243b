# exercise_1_2.three_ints: the blocking call() while the node is spun in the background; the first step is left as it was.

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    node = Node("three_ints")
    client = node.create_client(AddTwoInts, "/add_two_ints")
    if not client.wait_for_service(patience_sec):
        node.destroy_node()
        raise TimeoutError(f"{client.srv_name}: not available")
    with spinning(node):
        first = client.call(AddTwoInts.Request(a=a, b=b))
        second = client.call(AddTwoInts.Request(a=c, b=first.sum))
    print("sum:", second.sum)
    return second.sum
