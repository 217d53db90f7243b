# Wrong: the nodes are made, and the list is empty.
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    rules = [('chatter', '/robot/status_updates')]
    Node(package='my_robot_pkg', executable='talker', remappings=rules)
    Node(package='my_robot_pkg', executable='listener', remappings=rules)
    return LaunchDescription([])
