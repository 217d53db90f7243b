# Right: ros2 run with a rule on its command line, a relative target.
from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description():
    def program(name):
        rule = 'chatter:=robot/status_updates'
        return ExecuteProcess(cmd=['ros2', 'run', 'my_robot_pkg', name, '--ros-args', '--remap', rule], output='screen')

    return LaunchDescription([program('talker'), program('listener')])
