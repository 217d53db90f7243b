# Wrong: the description is not returned.
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    rules = [('chatter', '/robot/status_updates')]
    LaunchDescription([
        Node(package='my_robot_pkg', executable='talker', remappings=rules),
        Node(package='my_robot_pkg', executable='listener', remappings=rules),
    ])
