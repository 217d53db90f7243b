# Right: both nodes with the same list of rules.
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    rules = [('chatter', '/robot/status_updates')]
    return LaunchDescription([
        Node(package='my_robot_pkg', executable='talker', remappings=rules, output='screen'),
        Node(package='my_robot_pkg', executable='listener', remappings=rules, output='screen'),
    ])
