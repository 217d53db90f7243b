# Right: a class with a timer.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32


class Battery(Node):
    def __init__(self):
        super().__init__("battery")
        self.charge = 100
        self.publisher = self.create_publisher(Int32, "battery", 10)
        self.create_timer(0.5, self.tell)

    def tell(self):
        self.publisher.publish(Int32(data=self.charge))
        self.charge -= 1


rclpy.init()
rclpy.spin(Battery())
