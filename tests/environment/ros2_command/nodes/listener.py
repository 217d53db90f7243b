"""Say what is heard on chatter."""

# mypy: disallow-untyped-calls=False

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


def main() -> None:
    rclpy.init()
    node = Node("listener")

    def hear(message: String) -> None:
        node.get_logger().info(f"heard {message.data}")

    node.create_subscription(String, "chatter", hear, 10)
    node.get_logger().info("ready")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
