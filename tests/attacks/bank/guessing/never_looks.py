# family = "guessing"
# assignment = "lab_1_3"
# tries = "The client makes its node and its client and gives up at once, whether the service is there or not: the only part that it does right is the one without a service."
# could_earn = "The point for ending clearly when there is no service."
# undefended = "One point: giving up counted in the one part alone."

# %% solution add_two_ints
def add_two_ints(a, b, patience_sec=5.0):
    node = rclpy.create_node("add_two_ints_client")
    node.create_client(AddTwoInts, "add_two_ints")
    raise TimeoutError("nobody offers add_two_ints")
