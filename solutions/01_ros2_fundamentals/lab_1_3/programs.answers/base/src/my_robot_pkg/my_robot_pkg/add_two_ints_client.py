import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException


def add_two_ints(a: int, b: int, patience_sec: float = 5.0) -> int:
    """The sum of a and b, as the service add_two_ints gives it.

    Raises TimeoutError when the service or its answer is not there within patience_sec seconds.
    """
    node = rclpy.create_node("add_two_ints_client")
    try:
        client = node.create_client(AddTwoInts, "add_two_ints")
        if not client.wait_for_service(timeout_sec=patience_sec):
            raise TimeoutError(f"the service add_two_ints is not available after {patience_sec} s")
        future = client.call_async(AddTwoInts.Request(a=a, b=b))
        rclpy.spin_until_future_complete(node, future, timeout_sec=patience_sec)
        if not future.done():
            raise TimeoutError(f"no answer within {patience_sec} s")
        node.get_logger().info(f"{a} + {b} = {future.result().sum}")
        return future.result().sum
    finally:
        node.destroy_node()


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit("usage: add_client A B")
    a, b = (int(text) for text in sys.argv[1:])
    rclpy.init()
    try:
        add_two_ints(a, b)
    except TimeoutError as problem:
        print("gave up:", problem)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
