# family = "crafted"
# tries = "The notebook is a folder of that name, with the notebook in it."
# could_earn = "A batch that ends over it."
# refused = true

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    (folder / "lab_1_2.ipynb").mkdir()
    nbformat.write(notebook, folder / "lab_1_2.ipynb" / "lab_1_2.ipynb")
