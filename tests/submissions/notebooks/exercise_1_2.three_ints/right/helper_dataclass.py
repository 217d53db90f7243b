# exercise_1_2.three_ints: an extra cell holds a class with a with-statement of its own; nothing is logged, the sum is returned.

# %% extra
class Adder:
    """A client of add_two_ints that puts its node away at the end of a with-block."""

    def __init__(self, patience_sec):
        self.patience_sec = patience_sec

    def __enter__(self):
        self.node = rclpy.create_node("adder")
        self.client = self.node.create_client(AddTwoInts, "add_two_ints")
        if not self.client.wait_for_service(timeout_sec=self.patience_sec):
            self.node.destroy_node()
            raise TimeoutError("service not available")
        return self

    def __exit__(self, *exc_info):
        self.node.destroy_node()

    def __call__(self, a, b):
        future = self.client.call_async(AddTwoInts.Request(a=a, b=b))
        while not future.done():
            rclpy.spin_once(self.node, timeout_sec=0.1)
        return future.result().sum

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    with Adder(patience_sec) as add:
        return add(add(a, b), c)
