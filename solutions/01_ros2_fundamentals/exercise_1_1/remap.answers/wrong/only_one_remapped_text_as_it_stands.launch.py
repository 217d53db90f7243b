# Wrong: the course text's own launch file: the listener's rule stands in a comment.
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([
        Node(
            package='my_robot_pkg',
            executable='talker',
            name='my_remapped_talker',
            remappings=[
                ('chatter', '/robot/status_updates')
            ]
        ),
        Node(
            package='my_robot_pkg',
            executable='listener',
            name='my_listener',
            # Listener will automatically subscribe to the remapped topic if it's the only one
            # or you can explicitly remap its subscription as well:
            # remappings=[
            # ('chatter', '/robot/status_updates')
            # ]
        )
    ])
