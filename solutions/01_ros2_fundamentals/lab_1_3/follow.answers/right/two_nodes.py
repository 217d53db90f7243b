"""Right: one node with the service, another one that drives; both in one executor."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool

rclpy.init()
switch, driver = rclpy.create_node("switch"), rclpy.create_node("driver")
wheels = driver.create_publisher(Twist, "cmd_vel", 10)
follows = [False]


def turn(request, response):
    follows.append(request.data)
    response.success = True
    response.message = ["staying", "following"][request.data]
    return response


def look(scan):
    command = Twist()
    command.linear.x = 0.5 if follows[-1] and scan.ranges[0] > 0.8 else 0.0
    wheels.publish(command)


switch.create_service(SetBool, "follow", turn)
driver.create_subscription(LaserScan, "scan", look, 10)
executor = SingleThreadedExecutor()
executor.add_node(switch)
executor.add_node(driver)
executor.spin()
