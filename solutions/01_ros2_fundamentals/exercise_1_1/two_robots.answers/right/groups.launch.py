from launch import LaunchDescription
from launch.actions import GroupAction
from launch_ros.actions import Node, PushRosNamespace, SetRemap


def robot(side):
    wheels = Node(package="robots_pkg", executable="wheels", name=f"{side}_wheels")
    return GroupAction([PushRosNamespace(side), SetRemap("cmd_vel", "/drive"), wheels])


def generate_launch_description():
    driver = Node(package="robots_pkg", executable="driver")
    return LaunchDescription([robot("left"), robot("right"), driver])
