"""A program that serves an interface type from a workspace, so that the judge can see the type on the wire.

Usage: ``python -m autograder.workspaces.interface_probe PACKAGE/srv/NAME SERVICE``
"""

from __future__ import annotations

import contextlib
import importlib
import sys


def main(type_name: str, service: str) -> None:
    """Offer a service of this type until interrupted. If the type cannot be imported, Python prints the traceback."""
    package, kind, name = type_name.split("/")
    interface = getattr(importlib.import_module(f"{package}.{kind}"), name)
    import rclpy
    from rclpy.executors import ExternalShutdownException

    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.init()
        node = rclpy.create_node("interface_probe")
        node.create_service(interface, service, lambda _, response: response)
        rclpy.spin(node)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
