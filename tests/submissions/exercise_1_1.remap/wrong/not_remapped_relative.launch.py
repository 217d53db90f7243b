# Wrong: a relative target, and a namespace in front of it.
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    rules = [('chatter', 'robot/status_updates')]
    return LaunchDescription([
        Node(package='my_robot_pkg', executable='talker', remappings=rules, namespace='left'),
        Node(package='my_robot_pkg', executable='listener', remappings=rules, namespace='left'),
    ])
