"""Finds interfaces: the classes by name, and the packages and files that contain them."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

_SUFFIXES = {"msg": (".msg", ".idl"), "srv": (".srv", ".idl"), "action": (".action", ".idl")}
# The attributes by which the kind of a generated class is recognized.
_PARTS = {"msg": ("SLOT_TYPES",), "srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}


def load_type(name: str, kind: str) -> Any:
    """Import the class of an interface.

    Args:
        name: The name, such as `std_msgs/msg/String` or, shorter, `std_msgs/String`.
        kind: msg, srv or action. It replaces a missing middle part of the name.

    Raises:
        ValueError: There is no interface of this name and kind.
    """
    *package, last = name.split("/")
    if len(package) == 1:
        package.append(kind)
    try:
        found = getattr(importlib.import_module(".".join(package)), last)
    except (ImportError, AttributeError, ValueError) as error:
        raise ValueError(f"no interface '{name}'") from error
    if not all(hasattr(found, part) for part in _PARTS[kind]):
        raise ValueError(f"'{name}' is not the name of a {kind}")
    return found


def interfaces_of(package: str, kind: str) -> list[str]:
    """Return the interfaces of a package, such as `msg/String`, in order.

    Raises:
        LookupError: The package does not exist.
    """
    from ament_index_python import get_resource, has_resource

    if not has_resource("packages", package):
        raise LookupError(f"Unknown package '{package}'")
    if not has_resource("rosidl_interfaces", package):
        return []
    content, _ = get_resource("rosidl_interfaces", package)
    return sorted(
        {
            line.rpartition(".")[0]
            for line in content.splitlines()
            # A name with an underscore is a part of another interface, such as Fibonacci_Goal of an action.
            if line.startswith(f"{kind}/") and line.endswith(_SUFFIXES[kind]) and "_" not in line
        }
    )


def interface_packages() -> list[str]:
    """Return the packages that have interfaces, in order."""
    from ament_index_python import get_resources

    return sorted(get_resources("rosidl_interfaces"))


def interface_file(name: str) -> Path:
    """Return the file that defines an interface.

    Args:
        name: The name, such as `std_msgs/msg/String`.

    Raises:
        ValueError: The name does not have three parts.
        LookupError: The package or the interface does not exist.
    """
    from ament_index_python import get_resource

    parts = name.split("/")
    if len(parts) != 3:
        raise ValueError(f"Invalid name '{name}'. Expected three parts separated by '/'")
    if not all(parts) or ".." in parts:
        raise ValueError(f"Invalid name '{name}'. Must not contain empty parts or '..'")
    try:
        _, prefix = get_resource("packages", parts[0])
    except LookupError:
        raise LookupError(f"Unknown package '{parts[0]}'") from None
    path = Path(prefix, "share", name)
    for candidate in (path.with_name(f"{parts[2]}.{parts[1]}"), path.with_name(f"{parts[2]}.idl")):
        if candidate.exists():
            return candidate
    raise LookupError(f"Could not find the interface '{path}.idl'")
