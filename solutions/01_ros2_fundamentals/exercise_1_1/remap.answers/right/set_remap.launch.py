# Right: one rule for a whole group.
from launch import LaunchDescription
from launch.actions import GroupAction
from launch_ros.actions import Node, SetRemap


def generate_launch_description():
    return LaunchDescription([
        GroupAction([
            SetRemap('chatter', '/robot/status_updates'),
            Node(package='my_robot_pkg', executable='talker'),
            Node(package='my_robot_pkg', executable='listener'),
        ])
    ])
