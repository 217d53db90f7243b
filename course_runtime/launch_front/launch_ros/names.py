"""Names of nodes and namespaces."""

from __future__ import annotations

import re  # noqa: TID251  (not what a student handed in)

_PART = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def check_node_name(name: str) -> None:
    """Check that a text is a valid name of a node.

    Raises:
        ValueError: It is not.
    """
    if not _PART.fullmatch(name):
        raise ValueError(
            f"Invalid node name: '{name}'. A name has letters, digits and underscores, no digit first"
        )


def check_namespace(namespace: str) -> None:
    """Check that a text is an absolute namespace.

    Raises:
        ValueError: It is not.
    """
    parts = namespace[1:].split("/")
    if namespace != "/" and (namespace[:1] != "/" or not all(_PART.fullmatch(part) for part in parts)):
        raise ValueError(
            f"Invalid namespace: '{namespace}'. Its parts have letters, digits and underscores, "
            "no digit first"
        )


def inner_namespace(outer: str | None, namespace: str | None) -> str | None:
    """Return a namespace inside another one as an absolute namespace; None if both are None.

    A namespace that begins with a slash stays unchanged.
    """
    if namespace is None:
        return outer
    if not namespace.startswith("/"):
        namespace = f"{(outer or '').rstrip('/')}/{namespace}"
    return namespace.rstrip("/") or "/"
