# family = "crafted"
# tries = "The file says that it is of format 99, with the cells where the format of 2011 has them."
# could_earn = "A batch that ends over it, or cells that nobody has checked."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    cells = [{"cell_type": "code", "input": "10.0", "outputs": [], "language": "python"}]
    text = json.dumps({"nbformat": 99, "nbformat_minor": 0, "metadata": {}, "worksheets": [{"cells": cells}]})
    (folder / "lab_1_2.ipynb").write_text(text)
