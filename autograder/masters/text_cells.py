"""Adds two things to text cells that Markdown does not have: hints that open one at a time, and figures.

An author writes one block after the other::

    :::{hint} Where do I begin?
    With the publisher.
    :::

    :::{hint} And then?
    With the timer.
    :::

In the notebook, hints become ``<details>``. Each hint is put inside the hint before it, so that a student cannot see
the second before opening the first.

Figures are embedded in a notebook, so that it can be moved to any folder. They are embedded as PNGs, because JupyterLab
does not show an attached SVG. :mod:`autograder.masters.drawing` draws each PNG from its SVG, and stores a digest of the
SVG in it, so that a PNG that is older than its SVG is noticed. Both files are committed.
"""

from __future__ import annotations

import base64
import hashlib
import re  # noqa: TID251  (not what a student handed in)
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from autograder.masters.master_errors import CellError

if TYPE_CHECKING:
    from pathlib import Path

OPENING = re.compile(r":::\{hint\}\s*(?P<question>.*?)\s*")
CLOSING = ":::"
REFERENCE = re.compile(r"!\[\]\((?P<path>[^)\s]+\.svg)\)")
"""Matches a line of a master that shows a figure. The alternative text is in the SVG, not in this line."""
KEYWORD = b"Drawn from SVG"
_SVG = "{http://www.w3.org/2000/svg}"


@dataclass(frozen=True)
class Hint:
    """A hint: the question that it answers, and the answer in Markdown."""

    question: str
    answer: str


def nest_hints(markdown: str) -> str:
    """Return ``markdown`` with every run of hint blocks replaced by nested ``<details>``.

    Raises:
        CellError: A hint has no question or no answer, contains another hint, or is never closed.
    """
    lines = markdown.split("\n")
    result: list[str] = []
    run: list[Hint] = []
    offset = 0
    while offset < len(lines):
        opening = OPENING.fullmatch(lines[offset])
        if opening:
            end = _closing(lines, offset)
            run.append(_hint(opening["question"], lines[offset + 1 : end], offset))
            offset = end + 1
            continue
        # Blank lines between two hints do not end the run.
        if run and lines[offset].strip():
            result.extend([_nested(run), ""])
            run = []
        if not run:
            result.append(lines[offset])
        offset += 1
    if run:
        result.append(_nested(run))
    return "\n".join(result)


def _closing(lines: list[str], opening: int) -> int:
    for offset in range(opening + 1, len(lines)):
        if OPENING.fullmatch(lines[offset]):
            break
        if lines[offset].strip() == CLOSING:
            return offset
    raise CellError(
        opening, "A hint that is not closed.", f"End it with a line '{CLOSING}' in the same text cell."
    )


def _hint(question: str, answer: list[str], offset: int) -> Hint:
    text = "\n".join(answer).strip("\n")
    if not question or not text.strip():
        raise CellError(
            offset, "A hint without its question, its answer, or both.", "Write ':::{hint} What is asked?'."
        )
    return Hint(question, text)


def _nested(hints: list[Hint]) -> str:
    text = ""
    for number, hint in reversed(list(enumerate(hints, 1))):
        inner = f"{hint.answer}\n\n{text}" if text else f"{hint.answer}\n"
        text = (
            f"<details>\n<summary><b>Hint {number} of {len(hints)}.</b> {hint.question}</summary>\n"
            # The blank lines make JupyterLab read the content as Markdown.
            f"<blockquote>\n\n{inner}\n</blockquote>\n</details>\n"
        )
    return text.rstrip("\n")


def attach_figures(folder: Path, markdown: str) -> tuple[str, dict[str, dict[str, str]]]:
    """Return the text of a text cell with its figures as attachments.

    Args:
        folder: The folder of the master. References to figures are relative to it.
        markdown: The text of the cell.

    Returns:
        The text with references to the attachments, and the attachments by name.

    Raises:
        CellError: A figure is missing, has no description, or its PNG is out of date.
    """
    figures: dict[str, dict[str, str]] = {}

    def shown(reference: re.Match[str]) -> str:
        line = markdown.count("\n", 0, reference.start())
        name, words, png = _read(folder / reference["path"], reference["path"], line)
        figures[name] = {"image/png": base64.b64encode(png).decode("ascii")}
        return f"![{words}](attachment:{name})"

    return REFERENCE.sub(shown, markdown), figures


def digest(svg: bytes) -> bytes:
    """Return the digest of an SVG. A PNG that was made from this SVG contains this digest, so an old PNG is noticed."""
    return hashlib.sha256(svg).hexdigest().encode("ascii")


def _read(svg: Path, named: str, line: int) -> tuple[str, str, bytes]:
    """Return the name of a figure's PNG, the figure's description, and the PNG itself."""
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
            line,
            f"The figure {named} is not an SVG ({error}).",
            "Write it as an SVG file that a browser shows.",
        ) from error
    words = [(root.findtext(f"{_SVG}{tag}") or "").strip() for tag in ("title", "desc")]
    if not all(words):
        raise CellError(
            line, f"The figure {named} has no description.", "Give its SVG a <title> and a <desc>."
        )
    if KEYWORD + b"\0" + digest(drawing) not in picture:
        raise CellError(
            line,
            f"The figure {named} has changed since its PNG was drawn.",
            "Draw it: python -m autograder.masters.drawing",
        )
    return (png.name, " ".join(re.sub(r"[\[\]]", "", ". ".join(words)).split()), picture)
