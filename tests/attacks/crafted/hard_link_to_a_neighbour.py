# family = "crafted"
# tries = "The notebook is the neighbour's file under a second name."
# could_earn = "The neighbour's points."
# refused = true

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tests.hard_links import hard_link

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    hard_link(folder / "lab_1_2.ipynb", folder.parents[1] / "honest_ada" / "lab_1_2" / "lab_1_2.ipynb")
