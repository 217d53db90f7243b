# Right: a namespace for both, and a relative target in it.
from launch import LaunchDescription
from launch.actions import GroupAction
from launch_ros.actions import Node, PushRosNamespace


def generate_launch_description():
    rules = [('chatter', 'status_updates')]
    return LaunchDescription([
        GroupAction([
            PushRosNamespace('robot'),
            Node(package='my_robot_pkg', executable='talker', remappings=rules),
            Node(package='my_robot_pkg', executable='listener', remappings=rules),
        ])
    ])
