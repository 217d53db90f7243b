from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    driver = Node(package="robots_pkg", executable="driver", remappings=[("drive", "/fleet/cmd_vel")])
    rules = [("cmd_vel", "/fleet/cmd_vel")]
    left = Node(package="robots_pkg", executable="wheels", namespace="left", remappings=rules)
    right = Node(package="robots_pkg", executable="wheels", namespace="right", remappings=rules)
    return LaunchDescription([left, right, driver])
