# Right: the callback only keeps, and a timer publishes what was kept.
import rclpy
from std_msgs.msg import Float64

rclpy.init()
node = rclpy.create_node("thermometer")
publisher = node.create_publisher(Float64, "/fahrenheit", 10)
kept = []


def publish_all():
    while kept:
        message = Float64()
        message.data = 1.8 * kept.pop(0).data + 32.0
        publisher.publish(message)


node.create_subscription(Float64, "/celsius", kept.append, 10)
node.create_timer(0.05, publish_all)
rclpy.spin(node)
