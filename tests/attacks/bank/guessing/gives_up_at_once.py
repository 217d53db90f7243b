# family = "guessing"
# assignment = "lab_1_4"
# tries = "The action client makes its client and gives up at once, whether there is a server or not: the only part that it does right is the one without a server."
# could_earn = "The point for ending clearly when there is no server."
# undefended = "One point: giving up counted in the one part alone."

# %% solution fibonacci
def fibonacci(order, patience_sec=5.0):
    node = rclpy.create_node("fibonacci_client")
    ActionClient(node, Fibonacci, "fibonacci")
    raise TimeoutError("nobody offers the action fibonacci")
