# exercise_1_2.three_ints: a function inside the function; waits, then spins, then calls; any human language.

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    knoten = rclpy.create_node("addierer")
    dienst = knoten.create_client(AddTwoInts, "add_two_ints")

    def plus(x, y):
        frage = AddTwoInts.Request()
        frage.a, frage.b = x, y
        return dienst.call(frage).sum

    try:
        if not dienst.wait_for_service(timeout_sec=patience_sec):
            raise TimeoutError("Der Dienst add_two_ints ist nicht da (not available).")
        with spinning(knoten):
            summe = plus(c, plus(a, b))
        knoten.get_logger().warning(f"Summe: {summe}")
        return summe
    finally:
        knoten.destroy_node()
