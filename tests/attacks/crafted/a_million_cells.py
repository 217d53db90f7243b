# family = "crafted"
# tries = "A notebook of a million cells, each of them next to nothing."
# could_earn = "A grader that runs out of memory or time."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    cell = '{"cell_type":"raw","metadata":{},"source":""}'
    text = json.dumps({**notebook, "cells": []})
    (folder / "lab_1_2.ipynb").write_text(
        text.replace('"cells": []', '"cells": [' + ",".join([cell] * 10**6) + "]")
    )
