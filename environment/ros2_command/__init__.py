"""The course's own `ros2` command, used where the real ros2cli is not installed.

It knows the words that the chapter teaches, with the options, the output form and the exit codes of Jazzy's
ros2cli, and says of everything else that it needs the full one. `docs/ros2-command.md` lists both.
"""
