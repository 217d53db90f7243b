# Right: the two nodes, with the same list of rules and nothing else.
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    rules = [('chatter', '/robot/status_updates')]
    return LaunchDescription([
        Node(package='my_robot_pkg', executable='talker', remappings=rules),
        Node(package='my_robot_pkg', executable='listener', remappings=rules),
    ])
