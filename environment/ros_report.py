"""A fresh Python process's report on its ROS, as one JSON object: ``python -m environment.ros_report``.

A process of its own, because a broken ROS does not always raise an exception: a wrong library can end the
process.
"""

from __future__ import annotations

import json
import os
import re  # noqa: TID251  (not what a student handed in)
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

# The fields of the course text.
INTERFACE_FIELDS = {
    "AddTwoInts.Request": {"a": "int64", "b": "int64"},
    "AddTwoInts.Response": {"sum": "int64"},
    "Fibonacci.Goal": {"order": "int32"},
    "Fibonacci.Result": {"sequence": "sequence<int32>"},
    "Fibonacci.Feedback": {"partial_sequence": "sequence<int32>"},
}


def rclpy_version() -> tuple[str, str]:
    """Return the version of rclpy and the prefix it is installed in, or two empty texts if none is found."""
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        package = Path(prefix) / "share/rclpy/package.xml"
        if prefix and package.exists():
            found = re.search(r"<version>\s*([\d.]+)\s*</version>", package.read_text(encoding="utf-8"))
            return _wheel_version() or (found.group(1) if found else ""), prefix
    return "", ""


def _wheel_version() -> str:
    # The wheel 7.1.6 has a package.xml that says 7.1.5; the lock file says what pip says.
    try:
        return version("ros-rclpy")
    except PackageNotFoundError:
        return ""


def interface_fields() -> dict[str, dict[str, str]]:
    """Return the fields of the interface package, in the form of `INTERFACE_FIELDS`."""
    from my_robot_interfaces.action import Fibonacci
    from my_robot_interfaces.srv import AddTwoInts

    types = (AddTwoInts.Request, AddTwoInts.Response, Fibonacci.Goal, Fibonacci.Result, Fibonacci.Feedback)
    return {
        f"{type_.__name__.replace('_', '.')}": dict(type_.get_fields_and_field_types()) for type_ in types
    }


def main() -> int:
    """Print the report; what could not be found out is an ``error`` of its part."""
    report: dict[str, object] = {}
    report["version"], report["prefix"] = rclpy_version()
    try:
        from rclpy.utilities import get_rmw_implementation_identifier

        report["rmw"] = get_rmw_implementation_identifier()
    except Exception as error:
        report["rclpy_error"] = f"{type(error).__name__}: {error}"
    try:
        report["fields"] = interface_fields()
    except Exception as error:
        report["interfaces_error"] = f"{type(error).__name__}: {error}"
    print(json.dumps(report))
    return 0


if __name__ == "__main__":
    main()
