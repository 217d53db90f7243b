# Right: tabs, print beside the logger (every text is there twice), emoji.
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
	def __init__(self, name="listener"):
		super().__init__(name)
		self.n = 0
		self.s = self.create_subscription(String, "chatter", self.cb, 10)

	def cb(self, msg: String) -> None:
		self.n += 1
		print("📨", msg.data, flush=True)
		self.get_logger().info("I heard: " + msg.data)


def main():
	rclpy.init()
	rclpy.spin(Listener())


if __name__ == "__main__":
	main()
