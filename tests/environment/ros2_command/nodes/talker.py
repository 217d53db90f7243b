"""Publish a line ten times a second, with the text of the parameter `words`."""

# mypy: disallow-untyped-calls=False

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self) -> None:
        super().__init__("talker")
        self.declare_parameter("words", "Hello")
        self.declare_parameter("rate", 10.0)
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.count = 0
        self.create_timer(1 / self.get_parameter("rate").value, self.say)

    def say(self) -> None:
        text = f"{self.get_parameter('words').value} {self.count}"
        self.count += 1
        self.get_logger().info(f"said {text}")
        self.publisher.publish(String(data=text))


def main() -> None:
    rclpy.init()
    node = Talker()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
