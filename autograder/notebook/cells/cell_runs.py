"""Tells which cell of the notebook is running, and whether this cell has run before.

JupyterLab sends the id of the cell with each request to run it (``cellId`` in the request's metadata, which IPython
passes to ``pre_run_cell``). Other front ends, such as nbclient and the console, send no id. For these, the text of a
cell serves as its identifier.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.notebook.cells.cell_output import notebook_shell

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class WatchedRun:
    """One run of one cell.

    Attributes:
        cell: The identifier of the cell, which is the same in all its runs.
        number: A counter that grows with each run of any cell.
    """

    cell: str
    number: int

    def is_later_run_of(self, other: WatchedRun | None) -> bool:
        """Return True if this is a later run of the same cell as ``other``."""
        return other is not None and self.cell == other.cell and self.number > other.number


class CellWatch:
    """Knows which cell is running (``current``). Outside a notebook, ``current`` is always None."""

    def __init__(self) -> None:
        self.current: WatchedRun | None = None
        self._before_run: list[Callable[[WatchedRun], None]] = []
        self._shell: Any = notebook_shell()
        if self._shell is None:
            return
        self._shell.events.register("pre_run_cell", self._cell_begins)
        # No event announces the cell that imports this module, because it is already running. So note it here.
        parent = self._parent_request()
        cell_id = parent.get("metadata", {}).get("cellId")
        self._set_current(cell_id, parent.get("content", {}).get("code", ""))

    def before_each_run(self, action: Callable[[WatchedRun], None]) -> None:
        """Register a function that is called before each run of a cell."""
        self._before_run.append(action)

    def _cell_begins(self, info: Any) -> None:
        run = self._set_current(getattr(info, "cell_id", None), info.raw_cell or "")
        for action in self._before_run:
            action(run)

    def _set_current(self, cell_id: str | None, source: str) -> WatchedRun:
        cell = cell_id or "text:" + hashlib.sha256(source.encode()).hexdigest()
        number = 1 if self.current is None else self.current.number + 1
        self.current = WatchedRun(cell, number)
        return self.current

    def _parent_request(self) -> dict[str, Any]:
        kernel = getattr(self._shell, "kernel", None)
        return (kernel.get_parent("shell") or {}) if kernel is not None else {}
