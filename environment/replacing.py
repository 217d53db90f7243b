"""Give a file another content in one step: after an interruption it has the old one or the new one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def replace_content(path: Path, content: bytes) -> None:
    """Replace what is in a file; its mode stays."""
    beside = path.with_name(f"{path.name}.new")
    beside.write_bytes(content)
    beside.chmod(path.stat().st_mode)
    beside.replace(path)
