"""Descriptions that a launch file can use."""

from launch.unsupported import names_elsewhere

from .parameter_descriptions import Parameter, ParameterFile, ParameterValue

__all__ = ["Parameter", "ParameterFile", "ParameterValue"]
__getattr__ = names_elsewhere("launch_ros.descriptions", ("ComposableNode", "ComposableLifecycleNode"))
