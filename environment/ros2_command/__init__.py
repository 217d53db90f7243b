"""The course's own `ros2` command, used if the real ros2cli is not installed.

The command has the words that the chapter teaches, with the options, output and exit codes of Jazzy's ros2cli, and
says of all other words that they need the full one. `docs/ros2-command.md` lists both.
"""
