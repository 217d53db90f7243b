# family = "crafted"
# tries = "NUL bytes and other control characters in the text of cells, and lone surrogates, as JSON may write them."
# could_earn = "A batch that ends over a text that no file can hold."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    text = nbformat.writes(notebook)
    odd = "\\u0000\\ud800\\udfff\\u001b[2J\\u202e\\ufeff"
    (folder / "lab_1_2.ipynb").write_text(text.replace("TODO", f"TODO {odd}"))
