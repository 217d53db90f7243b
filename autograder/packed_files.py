"""Files of a hand-out that no student should read by chance, packed so that no editor and no search shows their text.

This keeps no secret: the judge and the cards on a student's computer unpack them, and a student can do the same.
"""

from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_BEGINNING = b"\x1f\x8b"
"""The first bytes of each gzip file (RFC 1952, 2.3.1)."""


def packed(content: bytes) -> bytes:
    """Return the content of a packed file. The same content always gives the same bytes."""
    return gzip.compress(content, mtime=0)


def read(path: Path) -> bytes:
    """Return the content of a file, packed or not.

    Raises:
        OSError: The file cannot be read.
        EOFError: The packed file is cut.
    """
    content = path.read_bytes()
    return gzip.decompress(content) if content.startswith(_BEGINNING) else content
