"""The socket on which notebooks reach their judge."""

from __future__ import annotations

import socket
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def listen(path: Path) -> socket.socket:
    """A Unix socket that notebooks of this user can connect to.

    Args:
        path: At most 107 bytes long (unix(7)).
    """
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    path.unlink(missing_ok=True)
    listener.bind(str(path))
    path.chmod(0o600)
    listener.listen(8)
    return listener
