"""The course's own `ros2` command, which is used if the real ros2cli is not installed.

The command has the words that the chapter teaches, with the options, output and exit codes of Jazzy's ros2cli. For
all other words it says that they need the full command. `docs/ros2-command.md` lists both.
"""
