"""Wrong: the TODO stub in a program."""
import rclpy


def find_service(type_name):
    node = rclpy.create_node('service_finder')
    node.destroy_node()


rclpy.init()
find_service('')
rclpy.shutdown()
