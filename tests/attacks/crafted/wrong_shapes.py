# family = "crafted"
# tries = "Everything has another type than it should: cells are numbers, sources are numbers, metadata is a list, the format's version is a text, names are objects."
# could_earn = "A batch that ends with an error of types."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    odd: list[Any] = [
        None,
        1,
        "x",
        [],
        {},
        {"cell_type": ["code"]},
        {"cell_type": "code", "source": 1e999, "metadata": []},
    ]
    odd += [{"cell_type": "code", "source": ["a", 1], "metadata": {"nbgrader": {"grade_id": {"a": 1}}}}]
    odd += [{"cell_type": "code", "source": "1/0", "metadata": {"nbgrader": {"grade_id": "lab_1_2-talker"}}}]
    text = json.dumps({**notebook, "cells": odd, "metadata": None, "nbformat_minor": "x"})
    (folder / "lab_1_2.ipynb").write_text(text)
