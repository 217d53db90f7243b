"""The owner of a folder: in a course that several people share, one of them has to set it up."""

from __future__ import annotations

import os
import pwd
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def owner(folder: Path) -> str:
    """The name of whoever a folder belongs to; its number where it has no name here."""
    number = folder.stat().st_uid
    try:
        return pwd.getpwuid(number).pw_name
    except KeyError:
        return f"user {number}"


def may_write(folder: Path) -> bool:
    """True if this user may write to a folder."""
    return os.access(folder, os.W_OK)
