from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    driver = Node(package="robots_pkg", executable="driver")
    left = Node(package="robots_pkg", executable="wheels", namespace="left")
    right = Node(package="robots_pkg", executable="wheels", namespace="right")
    return LaunchDescription([driver, left, right])
