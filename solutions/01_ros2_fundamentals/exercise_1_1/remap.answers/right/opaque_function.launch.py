# Right: a function makes the nodes, each with the rule among its ros_arguments.
from launch import LaunchDescription
from launch.actions import OpaqueFunction
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([OpaqueFunction(function=nodes)])


def nodes(context):
    rule = ['--remap', 'chatter:=/robot/status_updates']
    return [Node(package='my_robot_pkg', executable=name, ros_arguments=rule) for name in ('talker', 'listener')]
