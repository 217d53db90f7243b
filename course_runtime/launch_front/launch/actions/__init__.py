"""The actions that a launch file can use."""

from ..unsupported import names_elsewhere
from .configuration import (
    DeclareLaunchArgument,
    PopLaunchConfigurations,
    PushLaunchConfigurations,
    SetLaunchConfiguration,
    UnsetLaunchConfiguration,
)
from .environment import AppendEnvironmentVariable, SetEnvironmentVariable, UnsetEnvironmentVariable
from .events import EmitEvent, RegisterEventHandler, Shutdown, UnregisterEventHandler
from .flow import GroupAction, LogInfo, OpaqueFunction, TimerAction
from .include import IncludeLaunchDescription
from .process import ExecuteProcess

__all__ = [
    "AppendEnvironmentVariable",
    "DeclareLaunchArgument",
    "EmitEvent",
    "ExecuteProcess",
    "GroupAction",
    "IncludeLaunchDescription",
    "LogInfo",
    "OpaqueFunction",
    "PopLaunchConfigurations",
    "PushLaunchConfigurations",
    "RegisterEventHandler",
    "SetEnvironmentVariable",
    "SetLaunchConfiguration",
    "Shutdown",
    "TimerAction",
    "UnregisterEventHandler",
    "UnsetEnvironmentVariable",
    "UnsetLaunchConfiguration",
]
__getattr__ = names_elsewhere(
    "launch.actions",
    (
        "ExecuteLocal",
        "OpaqueCoroutine",
        "PopEnvironment",
        "PushEnvironment",
        "ResetEnvironment",
        "ResetLaunchConfigurations",
    ),
)
