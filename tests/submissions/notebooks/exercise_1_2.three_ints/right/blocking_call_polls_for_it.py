# exercise_1_2.three_ints: looks ten times a second for the service, then makes blocking calls in the background's spinning.

# %% extra
import time

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    node = Node("patient_client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    deadline = time.monotonic() + patience_sec
    while not client.service_is_ready():
        if time.monotonic() > deadline:
            node.destroy_node()
            raise TimeoutError(f"add_two_ints not available within {patience_sec} s")
        time.sleep(0.1)
    with spinning(node):
        total = a
        for term in (b, c):
            total = client.call(AddTwoInts.Request(a=total, b=term)).sum
    print(f"{a} + {b} + {c} = {total}")
    return total
