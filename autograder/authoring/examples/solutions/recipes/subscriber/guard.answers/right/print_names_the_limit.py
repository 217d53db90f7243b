# Right: prints, and names the limit in each line.
import rclpy
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int32


def heard(message):
    if message.data <= 19:
        print(f"{message.data}% is less than 20%: charge me!", flush=True)


rclpy.init()
node = rclpy.create_node("listener")
node.create_subscription(Int32, "/battery", heard, qos_profile_sensor_data)
while rclpy.ok():
    rclpy.spin_once(node)
