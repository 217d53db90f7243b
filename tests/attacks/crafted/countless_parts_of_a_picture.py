# family = "crafted"
# tries = "A text cell shows a JPEG of seven million fill bytes, and another one a GIF of two million empty blocks."
# could_earn = "A grader whose own process reads each byte on its own, several times for a page, while nobody else is graded."
# undefended = "Five seconds of the grader's own process for a page."

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

PICTURES = {
    "image/jpeg": b"\xff\xd8" + b"\xff" * 5_000_000,
    "image/png": b"GIF89a" + b"\1\0\1\0\0\0\0" + b"\x21\xf9\0" * 600_000,
}


def hand_in(folder: Path, notebook: Any) -> None:
    for kind, data in PICTURES.items():
        cell = nbformat.v4.new_markdown_cell("![a picture](attachment:picture)")
        cell.attachments = {"picture": {kind: base64.b64encode(data).decode()}}
        notebook.cells.append(cell)
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
