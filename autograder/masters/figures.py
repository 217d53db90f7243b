"""Figures: drawn once as SVG, carried by a notebook as a PNG inside the text cell that shows it.

A notebook has to show its figures wherever it is, so they travel in it. As a PNG, because no SVG that is attached to
a cell is shown by JupyterLab, and no file beside the notebook follows it into a student's folder. The PNG is drawn from
the SVG by :mod:`autograder.masters.drawing` and committed beside it; it holds a digest of the SVG, so that a figure
that was changed and not drawn again is noticed.
"""

from __future__ import annotations

import base64
import hashlib
import re
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from autograder.masters.master_errors import CellError

if TYPE_CHECKING:
    from pathlib import Path

REFERENCE = re.compile(r"!\[\]\((?P<path>[^)\s]+\.svg)\)")
"""A master's line that shows a figure: without an alternative text, which is taken from the SVG."""
KEYWORD = b"Drawn from SVG"
SIGNATURE = b"\x89PNG\r\n\x1a\n"
"""The first bytes of a PNG."""
_HEADER_LENGTH = len(SIGNATURE) + 8 + 13 + 4
_SVG = "{http://www.w3.org/2000/svg}"


@dataclass(frozen=True)
class Figure:
    """A figure as a notebook carries it.

    Attributes:
        name: The name of the attachment.
        alternative: What it shows, in words, for those who do not see it.
        png: The picture.
    """

    name: str
    alternative: str
    png: bytes

    @property
    def attachment(self) -> dict[str, str]:
        """The picture as nbformat keeps it."""
        return {"image/png": base64.b64encode(self.png).decode("ascii")}


def attach_figures(folder: Path, markdown: str) -> tuple[str, dict[str, dict[str, str]]]:
    """A text cell that brings its figures along.

    Args:
        folder: Where the master is; its references start from there.
        markdown: The text of the cell.

    Returns:
        The text, which shows the attachments, and the attachments by their names.

    Raises:
        CellError: A figure is missing, has no words, or its PNG is not drawn from it.
    """
    figures: dict[str, Figure] = {}

    def shown(reference: re.Match[str]) -> str:
        line = markdown.count("\n", 0, reference.start())
        figure = _read(folder / reference["path"], reference["path"], line)
        figures[figure.name] = figure
        return f"![{figure.alternative}](attachment:{figure.name})"

    text = REFERENCE.sub(shown, markdown)
    return text, {name: figure.attachment for name, figure in figures.items()}


def digest(svg: bytes) -> bytes:
    """The digest in a PNG of the SVG from which it was drawn."""
    return hashlib.sha256(svg).hexdigest().encode("ascii")


def signed(png: bytes, svg: bytes) -> bytes:
    """A PNG that says from which SVG it was drawn, in a text chunk behind its header.

    Args:
        png: The picture.
        svg: What it was drawn from.
    """
    mark = chunk(b"tEXt", KEYWORD + b"\0" + digest(svg))
    return png[:_HEADER_LENGTH] + mark + png[_HEADER_LENGTH:]


def chunk(kind: bytes, content: bytes) -> bytes:
    """A part of a PNG file: its length, its kind, what is in it, and its checksum."""
    return len(content).to_bytes(4) + kind + content + zlib.crc32(kind + content).to_bytes(4)


def _read(svg: Path, named: str, line: int) -> Figure:
    png = svg.with_suffix(".png")
    try:
        drawing, picture = svg.read_bytes(), png.read_bytes()
        root = ElementTree.fromstring(drawing)
    except FileNotFoundError as error:
        raise CellError(
            line,
            f"The figure {named} needs {error.filename}.",
            "Draw it: python -m autograder.masters.drawing",
        ) from error
    except ElementTree.ParseError as error:
        raise CellError(
            line, f"The figure {named} is no SVG ({error}).", "Write it as an SVG file that a browser shows."
        ) from error
    words = [(root.findtext(f"{_SVG}{tag}") or "").strip() for tag in ("title", "desc")]
    if not all(words):
        raise CellError(line, f"The figure {named} has no words.", "Give its SVG a <title> and a <desc>.")
    if KEYWORD + b"\0" + digest(drawing) not in picture:
        raise CellError(
            line,
            f"The figure {named} has changed since its PNG was drawn.",
            "Draw it: python -m autograder.masters.drawing",
        )
    return Figure(png.name, " ".join(re.sub(r"[\[\]]", "", ". ".join(words)).split()), picture)
