"""Set the environment variables that a judge's or subject's process needs before it imports ROS.

A participant of Jazzy's Fast DDS announces itself every 3 s (measured). So an older participant often discovers a new
process only seconds after the process has started. Therefore the judge's participants use the profile next to this
file, with which they announce themselves every 100 ms. Subjects do not need the profile.
"""

from __future__ import annotations

import atexit
import os
from pathlib import Path

from autograder.temporary_folders import HeldFolder
from environment.python_child import TYPED_PYTHONPATH

_LOG_FOLDER = "ROS_LOG_DIR"
PROFILE = Path(__file__).with_name("fastdds_profile.xml")
OF_THE_JUDGE = {
    "FASTDDS_DEFAULT_PROFILES_FILE": str(PROFILE),
    "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILE),
    # Without this variable, Fast DDS also reads a file DEFAULT_FASTRTPS_PROFILES.xml in the current folder.
    "SKIP_DEFAULT_XML_FILE": "1",
}
"""Environment variables for the judge's process that a subject must not have."""


def ros_environment() -> dict[str, str]:
    """Return the environment variables for judge and subject: ROS on loopback only, plain logs, messages over UDP.

    Messages go over UDP and not through shared memory, because two sandboxes have no memory in common. But because
    discovery is limited to this machine, rmw_fastrtps creates shared memory that no message uses. If a killed program
    leaves such memory behind, :mod:`autograder.judge.serving.domain` removes it.
    """
    return {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
        "RCUTILS_COLORIZED_OUTPUT": "0",
        "RCUTILS_LOGGING_USE_STDOUT": "1",
    }


def boxed_ros_environment() -> dict[str, str]:
    """Return the environment variables for judge and subject in two sandboxes that have only a network in common.

    The discovery range is not limited to this machine here, because rmw_fastrtps would then ignore
    ``FASTDDS_BUILTIN_TRANSPORTS`` and use shared memory (participant.cpp): judge and subject would discover each other,
    but no message would arrive. A limit is not needed, because no other program is on such a network.
    """
    return {**ros_environment(), "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}


def prepare_judge(*, boxed: bool = False) -> None:
    """Set the environment variables of this process for a judge. Call this before rclpy is imported.

    Args:
        boxed: True if only the judge and its subject are on this network.
    """
    os.environ.update(boxed_ros_environment() if boxed else ros_environment())
    os.environ.update(OF_THE_JUDGE)
    os.environ.pop("RMW_IMPLEMENTATION", None)
    provide_log_folder()


def subject_environment(domain_id: int, *, boxed: bool = False) -> dict[str, str]:
    """Return the environment variables for a command: the user's own variables, and the ROS domain of the check."""
    environment = {name: value for name, value in os.environ.items() if name not in OF_THE_JUDGE}
    if typed := environment.pop(TYPED_PYTHONPATH, ""):
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, (typed, environment.get("PYTHONPATH"))))
    environment.update(boxed_ros_environment() if boxed else ros_environment())
    environment["ROS_DOMAIN_ID"] = str(domain_id)
    environment["PYTHONUNBUFFERED"] = "1"
    # With this variable, a Python program that hangs prints the stacks of its threads when the judge aborts it.
    environment["PYTHONFAULTHANDLER"] = "1"
    return environment


def provide_log_folder() -> None:
    """Create a folder for ROS logs unless ``ROS_LOG_DIR`` names one. The folder is removed when this process ends.

    Without a folder for logs, rclpy does not start: rcl_logging_spdlog reports "Failed opening file".
    """
    if not os.environ.get(_LOG_FOLDER):
        folder, owner = HeldFolder("autograder-ros-logs-"), os.getpid()
        os.environ[_LOG_FOLDER] = str(folder.path)

        @atexit.register
        def remove() -> None:
            if os.getpid() == owner:  # a forked child that exits must not remove the folder
                folder.remove()
