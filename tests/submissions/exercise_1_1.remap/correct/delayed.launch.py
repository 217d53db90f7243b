# Right: the listener is started four seconds after the talker.
from launch import LaunchDescription
from launch.actions import TimerAction
from launch_ros.actions import Node


def generate_launch_description():
    rules = [('chatter', '/robot/status_updates')]
    listener = Node(package='my_robot_pkg', executable='listener', remappings=rules)
    return LaunchDescription([
        Node(package='my_robot_pkg', executable='talker', remappings=rules),
        TimerAction(period=4.0, actions=[listener]),
    ])
