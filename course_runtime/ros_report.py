"""Reports on the ROS that a new Python process finds, as one JSON object: ``python -m course_runtime.ros_report``.

This is a separate process, because a broken ROS does not always raise an exception: a wrong library may end the
process.
"""

from __future__ import annotations

import json
import os
import re  # noqa: TID251  (not what a student handed in)
import sys
from pathlib import Path

# The fields that the course's text defines.
INTERFACE_FIELDS = {
    "AddTwoInts.Request": {"a": "int64", "b": "int64"},
    "AddTwoInts.Response": {"sum": "int64"},
    "Fibonacci.Goal": {"order": "int32"},
    "Fibonacci.Result": {"sequence": "sequence<int32>"},
    "Fibonacci.Feedback": {"partial_sequence": "sequence<int32>"},
}


def rclpy_version() -> tuple[str, str]:
    """Return the version of rclpy and the prefix in which it is installed; two empty texts if there is none.

    The version is that of the code, from its ``package.xml``: the wheel called ros-rclpy 7.1.6 contains 7.1.5.
    """
    # A wheel that is not installed by the course's set-up has no AMENT_PREFIX_PATH.
    for prefix in [*os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep), sys.prefix]:
        package = Path(prefix) / "share/rclpy/package.xml"
        if prefix and package.exists():
            found = re.search(r"<version>\s*([\d.]+)\s*</version>", package.read_text(encoding="utf-8"))
            return found.group(1) if found else "", prefix
    return "", ""


def interface_fields() -> dict[str, dict[str, str]]:
    """Return the fields of the course's interfaces, in the form of `INTERFACE_FIELDS`."""
    from my_robot_interfaces.action import Fibonacci
    from my_robot_interfaces.srv import AddTwoInts

    types = (AddTwoInts.Request, AddTwoInts.Response, Fibonacci.Goal, Fibonacci.Result, Fibonacci.Feedback)
    return {
        f"{type_.__name__.replace('_', '.')}": dict(type_.get_fields_and_field_types()) for type_ in types
    }


def main() -> int:
    """Print the report. A part that could not be found out contains an ``error``."""
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
