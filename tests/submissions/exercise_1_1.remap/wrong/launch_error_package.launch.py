# Wrong: there is no package my_robot.
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    rules = [('chatter', '/robot/status_updates')]
    return LaunchDescription([
        Node(package='my_robot', executable='talker', remappings=rules),
        Node(package='my_robot', executable='listener', remappings=rules),
    ])
