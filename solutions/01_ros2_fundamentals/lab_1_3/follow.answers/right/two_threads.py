"""Right: several threads, no class, a log line for each request."""
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.executors import MultiThreadedExecutor
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool

rclpy.init()
node = rclpy.create_node("follower")
publisher = node.create_publisher(Twist, "/cmd_vel", 10)
state = "staying"


def on_follow(request, response):
    global state
    state = {True: "following", False: "staying"}[request.data]
    node.get_logger().info(state)
    response.message, response.success = state, True
    return response


def on_scan(scan):
    drives = state == "following" and scan.ranges[0] > 0.8
    publisher.publish(Twist(linear=Vector3(x=0.5 if drives else 0.0)))


service = node.create_service(SetBool, "follow", on_follow)
subscription = node.create_subscription(LaserScan, "/scan", on_scan, 10)
executor = MultiThreadedExecutor()
executor.add_node(node)
executor.spin()
