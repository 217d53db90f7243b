# family = "forging"
# tries = "The talker is right. Names of cells are exchanged, so that the talker's check stands where the listener's was and is made twice."
# could_earn = "The listener's points for the talker's work."
# earned = { "lab_1_2.talker" = 10 }

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

TALKER = """
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.count = 0
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, self.say_hello)

    def say_hello(self):
        self.publisher_.publish(String(data=f"Hello, world! {self.count}"))
        self.count += 1
"""


def hand_in(folder: Path, notebook: Any) -> None:
    named = {
        cell.metadata["nbgrader"]["grade_id"]: cell for cell in notebook.cells if "nbgrader" in cell.metadata
    }
    named["TalkerNode"].source = TALKER
    talker, listener = named["lab_1_2-talker"], named["lab_1_2-listener"]
    listener.source = talker.source
    talker.metadata["nbgrader"], listener.metadata["nbgrader"] = (
        listener.metadata["nbgrader"],
        talker.metadata["nbgrader"],
    )
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
