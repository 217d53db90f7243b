"""Computes how much of a browser's memory pictures would take, in pixels.

Pixels are counted because even a small file can have very many: a PNG of 30 kB with 16,000 x 16,000 pixels takes a
gigabyte in a browser. The number is read from the picture's header, without decoding the picture. In an animated PNG,
the pixels of each frame are counted. Sources: PNG specification (W3C, third edition), 11.2 and 11.3.6; ITU-T T.81,
B.2.2.
"""

from __future__ import annotations

import base64
import binascii
import itertools
import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


MOST_PIXELS = 100_000_000
"""The maximum number of pixels of all pictures on a notebook's page: a dozen 4K screenshots, or 400 MB in a
browser.
"""
_MOST_PARTS = 100_000
"""The maximum number of parts of a picture to look at: chunks or segments. A file of millions of empty ones would keep
the grader busy for seconds.
"""
_PNG = b"\x89PNG\r\n\x1a\n"
_NO_SIZE = {0xC4, 0xC8, 0xCC}
"""The JPEG markers from 0xC0 to 0xCF that do not start a frame: DHT (Huffman tables), JPG (reserved), DAC (arithmetic
conditioning).
"""
_ALONE = {0x01, *range(0xD0, 0xD8)}
"""The JPEG markers without a segment: TEM, and RST0 to RST7."""


class PixelBudget:
    """Counts the pixels of a notebook's pictures up to the limit ``MOST_PIXELS``."""

    def __init__(self) -> None:
        self._left = MOST_PIXELS

    def fit(self, encoded: str) -> bool:
        """Count the pixels of a base64 picture, and return True.

        If it is not a valid PNG or JPEG, or the pixels would exceed the limit, count none and return False.
        """
        pixels = pixels_of(encoded)
        if pixels is None or pixels > self._left:
            return False
        self._left -= pixels
        return True


def pixels_of(encoded: str) -> int | None:
    """Return the number of pixels of a base64 picture, in all frames; None if it is not a PNG or JPEG.

    The type is recognized by the first bytes, as in a browser, not by the type that the notebook declares.
    """
    try:
        data = base64.b64decode(encoded)
        if data.startswith(_PNG):
            return _pixels_of_png(data)
        if data.startswith(b"\xff\xd8"):
            return _pixels_of_jpeg(data)
    except (binascii.Error, ValueError, struct.error, IndexError):
        pass  # the picture is incomplete, or is not a picture
    return None


def _pixels_of_png(data: bytes) -> int | None:
    width, height = struct.unpack_from(">4x4sII", data, 8)[1:] if data[12:16] == b"IHDR" else (0, 0)
    frames, offset = 1, 8
    for _ in _parts():
        if data[offset + 4 : offset + 8] in (b"", b"IDAT"):
            break
        if data[offset + 4 : offset + 8] == b"acTL":
            (frames,) = struct.unpack_from(">I", data, offset + 8)
        offset += 12 + int.from_bytes(data[offset : offset + 4])
    return width * height * max(1, frames) or None


def _pixels_of_jpeg(data: bytes) -> int | None:
    offset, parts = 2, _parts()
    while next(parts) and offset < len(data):
        kind = data[offset + 1] if data[offset] == 0xFF else 0xFF
        if kind == 0xFF or kind in _ALONE:
            offset += 1 if kind == 0xFF else 2
        elif 0xC0 <= kind <= 0xCF and kind not in _NO_SIZE:
            height, width = struct.unpack_from(">HH", data, offset + 5)
            return height * width or None
        else:
            offset += 2 + max(2, int.from_bytes(data[offset + 2 : offset + 4]))
    return None


def _parts() -> Iterator[bool]:
    """Yield True for each part of a picture that may be looked at, and then raise an error."""
    yield from itertools.repeat(True, _MOST_PARTS)
    raise ValueError("the picture has too many parts")
