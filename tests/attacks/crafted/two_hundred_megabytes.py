# family = "crafted"
# tries = "A notebook of 200 MB."
# could_earn = "A grader that runs out of memory."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    text = json.dumps(notebook)
    with (folder / "lab_1_2.ipynb").open("w") as file:
        file.write(text[:-1] + ', "padding": "')
        for _ in range(200):
            file.write("x" * 1_000_000)
        file.write('"}')
