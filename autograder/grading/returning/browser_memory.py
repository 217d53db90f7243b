"""Computes how much of a browser's memory pictures and tables would take: in pixels, and in positions of a table.

Pixels are counted because even a small file can have very many: a PNG of 30 kB with 16,000 x 16,000 pixels takes a
gigabyte in a browser. The number is read from the picture's header, without decoding the picture. In an animated
picture, the pixels of each frame are counted. Sources: PNG specification (W3C, third edition), 11.2 and 11.3.6; GIF89a,
18 to 26; ITU-T T.81, B.2.2; RFC 9649.

The positions of a table are its rows times its columns. They are counted because a browser needs memory for each
position, even if the position has no cell. A cell of twenty characters may span 1,000 columns, so 46 kB of text can
make a table that no browser can open.
"""

from __future__ import annotations

import base64
import binascii
import itertools
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


MOST_PIXELS = 100_000_000
"""The maximum number of pixels of all pictures on a notebook's page: a dozen 4K screenshots, or 400 MB in a
browser.
"""
_MOST_PARTS = 100_000
"""The maximum number of parts of a picture to look at: chunks, blocks or segments. A GIF of 10 MB has 50,000. A file of
millions of empty ones would keep the grader busy for seconds.
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

    def fit(self, encoded: Iterable[str]) -> bool:
        """Count the pixels of base64 pictures, and return True.

        If the pixels would exceed the limit, count none and return False.
        """
        wanted = sum(pixels_of(picture) or 0 for picture in encoded)
        if wanted > self._left:
            return False
        self._left -= wanted
        return True


def may_be_shown(encoded: str) -> bool:
    """Return True if a page may show a base64 picture: a valid PNG, JPEG, GIF or WebP with few enough pixels."""
    pixels = pixels_of(encoded)
    return pixels is not None and pixels <= MOST_PIXELS


def pixels_of(encoded: str) -> int | None:
    """Return the number of pixels of a base64 picture, in all frames; None if it is not a PNG, JPEG, GIF or WebP.

    The type is recognized by the first bytes, as in a browser, not by the type that the notebook declares.
    """
    try:
        data = base64.b64decode(encoded)
        if data.startswith(_PNG):
            return _pixels_of_png(data)
        if data.startswith((b"GIF87a", b"GIF89a")):
            return _pixels_of_gif(data)
        if data.startswith(b"\xff\xd8"):
            return _pixels_of_jpeg(data)
        if data[:4] == b"RIFF" and data[8:12] == b"WEBP":
            return _pixels_of_webp(data)
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


def _pixels_of_gif(data: bytes) -> int | None:
    width, height, flags = struct.unpack_from("<HHB", data, 6)
    offset, frames = 13 + _colors(flags), 0
    parts = _parts()
    while offset < len(data) and data[offset] != 0x3B:
        if data[offset] == 0x2C:
            left, top, wide, high, flags = struct.unpack_from("<HHHHB", data, offset + 1)
            # If a frame extends beyond the picture, a browser makes the whole picture larger.
            width, height, frames = max(width, left + wide), max(height, top + high), frames + 1
            offset += 11 + _colors(flags)
        else:
            offset += 2
        while next(parts) and offset < len(data) and data[offset]:
            offset += 1 + data[offset]
        offset += 1
    return width * height * frames or None


def _parts() -> Iterator[bool]:
    """Yield True for each part of a picture that may be looked at, and then raise an error."""
    yield from itertools.repeat(True, _MOST_PARTS)
    raise ValueError("the picture has too many parts")


def _colors(flags: int) -> int:
    """Return the size of a color table in bytes."""
    return 3 << (flags & 7) + 1 if flags & 0x80 else 0


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


def _pixels_of_webp(data: bytes) -> int | None:
    pixels, frames = 0, 0
    for kind, at in _chunks(data):
        if kind == b"VP8X":
            wide, high = (int.from_bytes(data[at + n : at + n + 3], "little") + 1 for n in (4, 7))
            pixels = max(pixels, wide * high)
        elif kind == b"VP8L":
            bits = int.from_bytes(data[at + 1 : at + 5], "little")
            pixels = max(pixels, ((bits & 0x3FFF) + 1) * ((bits >> 14 & 0x3FFF) + 1))
        elif kind == b"VP8 ":
            wide, high = struct.unpack_from("<HH", data, at + 6)
            pixels = max(pixels, (wide & 0x3FFF) * (high & 0x3FFF))
        frames += kind == b"ANMF"
    return pixels * max(1, frames) or None


def _chunks(data: bytes) -> Iterator[tuple[bytes, int]]:
    """Yield the type of each WebP chunk, and the offset of its content in bytes."""
    offset, parts = 12, _parts()
    while next(parts) and offset + 8 <= len(data):
        yield data[offset : offset + 4], offset + 8
        size = int.from_bytes(data[offset + 4 : offset + 8], "little")
        offset += 8 + size + size % 2


# Matches the tags of tables as nh3 writes them: the values of attributes are in double quotes, and contain no double
# quotes.
_OF_TABLES = re2.compile(r"""<(/?table|tr|td|th)\b((?: [a-z]+="[^"]*")*)>""")
_SPAN = re2.compile(r' (colspan|rowspan)="([0-9]+)"')


def positions_in_tables(page: str) -> int:
    """Return the sum, over all tables, of rows times columns, which is an upper limit of the real size.

    Args:
        page: HTML that nh3 has cleaned.
    """
    positions = 0
    tables: list[_Table] = []
    for name, attributes in ((found[1], found[2]) for found in _OF_TABLES.finditer(page)):
        if name == "table":
            tables.append(_Table())
        elif name == "/table" and tables:
            positions += tables.pop().positions
        elif tables:
            spans = {span[1]: int(span[2]) for span in _SPAN.finditer(attributes)}
            tables[-1].add(name, spans.get("colspan", 1), spans.get("rowspan", 1))
    return positions


@dataclass
class _Table:
    """The size of a table while its tags are read.

    Attributes:
        rows: The number of rows so far.
        width: The number of columns that the cells of the current row take.
        widest: The largest number of columns in any row.
        reaching: The number of columns of all cells that span into later rows, where they move other cells to the side.
    """

    rows: int = 0
    width: int = 0
    widest: int = 0
    reaching: int = 0

    def add(self, name: str, columns: int, rows: int) -> None:
        """Count a new row, or a cell."""
        if name == "tr":
            self.rows, self.width = self.rows + 1, 0
            return
        self.width += columns
        self.widest = max(self.widest, self.width)
        self.reaching += columns if rows != 1 else 0

    @property
    def positions(self) -> int:
        """The number of rows times the largest possible number of columns."""
        return self.rows * (self.widest + self.reaching)
