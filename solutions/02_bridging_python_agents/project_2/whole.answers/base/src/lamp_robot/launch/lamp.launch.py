from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    bridge = Node(package="lamp_robot", executable="bridge", output="screen")
    limits = [{"max_forward": 0.4, "max_turn": 0.8}]
    hands = Node(package="lamp_robot", executable="safe_hands", parameters=limits, output="screen")
    return LaunchDescription([bridge, hands])
