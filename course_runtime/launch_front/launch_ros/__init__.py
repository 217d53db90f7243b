"""The course's own `launch_ros`, used if the real one is not installed: ROS nodes in launch files."""

from . import actions, descriptions, parameter_descriptions, substitutions

__all__ = ["actions", "descriptions", "parameter_descriptions", "substitutions"]
