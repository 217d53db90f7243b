"""The actions about ROS that a launch file can use."""

from launch.unsupported import names_elsewhere

from .node import Node
from .scope import PushROSNamespace, SetParameter, SetRemap

# Both spellings are in use.
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
