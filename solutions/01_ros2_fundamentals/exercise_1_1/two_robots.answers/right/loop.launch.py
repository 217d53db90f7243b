from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    robots = [
        Node(package="robots_pkg", executable="wheels", namespace=side, remappings=[("cmd_vel", "/drive")])
        for side in ("left", "right")
    ]
    return LaunchDescription([Node(package="robots_pkg", executable="driver"), *robots])
