from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    rules = [("cmd_vel", "/drive")]
    driver = Node(package="robots_pkg", executable="driver")
    left = Node(package="robots_pkg", executable="wheels", namespace="left", remappings=rules)
    right = Node(package="robots_pkg", executable="wheels", remappings=rules)
    return LaunchDescription([driver, left, right])
