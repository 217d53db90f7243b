# Right: beside the two programs, commands show what is said under the new name and how often.
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node

TOPIC = '/robot/status_updates'


def generate_launch_description():
    rules = [('chatter', TOPIC)]
    return LaunchDescription([
        Node(package='my_robot_pkg', executable='talker', remappings=rules, output='screen'),
        Node(package='my_robot_pkg', executable='listener', remappings=rules, output='screen'),
        ExecuteProcess(cmd=['ros2', 'topic', 'echo', TOPIC, 'std_msgs/msg/String'], output='screen'),
        ExecuteProcess(cmd=['ros2', 'topic', 'hz', TOPIC], output='log'),
    ])
