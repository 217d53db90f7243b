# Right: the rule comes before both programs.
from launch import LaunchDescription
from launch_ros.actions import Node, SetRemap


def generate_launch_description():
    return LaunchDescription([
        SetRemap("chatter", "/robot/status_updates"),
        Node(package="my_robot_pkg", executable="listener", output="screen"),
        Node(package="my_robot_pkg", executable="talker", output="screen"),
    ])
