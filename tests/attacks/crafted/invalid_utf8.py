# family = "crafted"
# tries = "Bytes that are no UTF-8, in the middle of a solution."
# could_earn = "A batch that ends with an error of encoding."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    data = json.dumps(notebook).encode()
    (folder / "lab_1_2.ipynb").write_bytes(data.replace(b"TODO", b"\xff\xfe\xed\xa0\x80TODO"))
