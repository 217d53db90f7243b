# Right: the target comes from a launch argument.
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    target = LaunchConfiguration('topic')
    ld = LaunchDescription()
    ld.add_action(DeclareLaunchArgument('topic', default_value='/robot/status_updates'))
    for program in ('talker', 'listener'):
        ld.add_action(Node(package='my_robot_pkg', executable=program, remappings=[('chatter', target)]))
    ld.add_action(LogInfo(msg=['both on ', target]))
    return ld
