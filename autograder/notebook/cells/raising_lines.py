"""The arrow of a traceback at the line that raised, also where a ``finally`` is below it.

IPython counts the lines of the file in which a frame's code is, to show long files in a quicker way. A cell's file is
not there, and so IPython 9 takes each cell for a long one. On the quick way the arrow is at the line at which the frame
was last: with ``finally`` that is the clean-up, and not what went wrong (Python's data model, "Traceback objects").
"""

from __future__ import annotations

import importlib
import linecache
from typing import TYPE_CHECKING, Any

from autograder.notebook.cells.student_tracebacks import notebook_shell

if TYPE_CHECKING:
    from types import FrameType

_COUNTS = "get_line_number_of_frame"
"""IPython's name of what counts the lines, in ``IPython.core.ultratb``."""


def point_at_raising_lines() -> None:
    """Have IPython count the lines of a cell as those of a file; outside of IPython nothing happens."""
    if notebook_shell() is None:
        return
    tracebacks: Any = importlib.import_module("IPython.core.ultratb")
    count = getattr(tracebacks, _COUNTS, None)
    if count is None or getattr(count, "knows_cells", False):
        return

    def lines_of(frame: FrameType) -> int:
        try:
            return int(count(frame))
        except OSError:
            lines = linecache.getlines(frame.f_code.co_filename, frame.f_globals)
            if not lines:
                raise
            return len(lines)

    lines_of.knows_cells = True  # type: ignore[attr-defined]
    setattr(tracebacks, _COUNTS, lines_of)
