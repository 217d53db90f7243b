# exercise_1_2.three_ints: the blocking call() while an executor of its own spins in a thread; the wait has a limit, the calls have none.

# %% extra
import threading

from rclpy.executors import SingleThreadedExecutor

# %% solution add_three_ints
def add_three_ints(a, b, c, patience_sec=5.0):
    node = rclpy.create_node("three_ints_client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    try:
        if not client.wait_for_service(timeout_sec=patience_sec):
            raise TimeoutError("the service add_two_ints was not available")
        thread.start()
        first = client.call(AddTwoInts.Request(a=a, b=b)).sum
        total = client.call(AddTwoInts.Request(a=first, b=c)).sum
        node.get_logger().info(f"sum: {total}")
        return total
    finally:
        executor.shutdown()
        if thread.is_alive():
            thread.join()
        node.destroy_node()
