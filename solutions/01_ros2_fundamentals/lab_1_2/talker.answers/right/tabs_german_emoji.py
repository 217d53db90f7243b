# Right: tabs, German names, emoji in the log, an absolute topic name.
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Sprecher(Node):
	def __init__(self):
		super().__init__("sprecher")
		self.kanal = self.create_publisher(String, "/chatter", 10)
		self.zähler = 0
		self.wecker = self.create_timer(.5, self.sprich)
		self.get_logger().info("Los geht es 🚀 mit dem Sprecher")

	def sprich(self):
		nachricht = String()
		nachricht.data = "Hello, world! " + f"{self.zähler}"
		self.kanal.publish(nachricht)
		self.get_logger().error(f"📣 gesendet: »{nachricht.data}«")
		print("✅", self.zähler)
		self.zähler += 1


rclpy.init()
rclpy.spin(Sprecher())
