"""The actions for ROS that a launch file can use."""

from launch.unsupported import names_elsewhere

from .node import Node
from .scope import PushROSNamespace, SetParameter, SetRemap

# Launch files use both spellings.
PushRosNamespace = PushROSNamespace

__all__ = ["Node", "PushROSNamespace", "PushRosNamespace", "SetParameter", "SetRemap"]
__getattr__ = names_elsewhere(
    "launch_ros.actions",
    (
        "ComposableNodeContainer",
        "LifecycleNode",
        "LifecycleTransition",
        "LoadComposableNodes",
        "ROSTimer",
        "RosTimer",
        "SetParametersFromFile",
        "SetROSLogDir",
        "SetUseSimTime",
    ),
)
