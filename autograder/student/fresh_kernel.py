"""Helps in a kernel that was just started, in which the notebook's given cells have not run yet.

JupyterLab's button *Check* asks :func:`cells_to_run` which given cells to run first. If a student runs a check cell by
hand instead, Python raises a ``NameError``. IPython loads this module as an extension, so that this error says what to
run. This module does not import ROS, so that a kernel starts as fast as without it.
"""

from __future__ import annotations

import ast
import builtins
import dis
import json
import os
from types import CodeType
from typing import TYPE_CHECKING, Any

from IPython.core.getipython import get_ipython

from autograder.student.lab import NOTEBOOKS_VARIABLE

if TYPE_CHECKING:
    from collections.abc import Sequence

_READS = ("LOAD_NAME", "LOAD_GLOBAL")
_BINDS = ("STORE_NAME", "STORE_GLOBAL")
_ADVICE = (
    "NameError: there is no {} yet. This kernel is new, and the cells above have not run in it. Press Check at the top "
    "right of this cell, which runs them first; or choose Run, then Run All Above Selected Cell, and run it again."
)


def cells_to_run(sources: Sequence[str], own: Sequence[int]) -> str:
    """Return the cells above a check that have to run before it in this kernel.

    A cell has to run if it defines a name that a later cell reads and that the kernel does not have yet. So no cell
    runs twice, and no demonstration runs that the check does not need.

    Args:
        sources: The code cells of the notebook, from the first one to the check cell.
        own: The indexes of the cells that run in any case: the student's answer, and the check.

    Returns:
        The indexes of the other cells to run, as JSON.
    """
    shell: Any = get_ipython()
    known = {*vars(builtins), *shell.user_ns}
    found, needed = list[int](), set[str]()
    for place in reversed(range(len(sources))):
        reads, binds = _names(shell.transform_cell(sources[place]))
        if place not in own:
            if not binds & needed - known:
                continue
            found.append(place)
        needed = needed - binds | reads
    return json.dumps(found[::-1])


def _names(source: str) -> tuple[set[str], set[str]]:
    """Return the names that a cell reads, even inside its functions, and the names that it defines."""
    try:
        codes = [compile(source, "a cell", "exec", dont_inherit=True, flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)]
    except (SyntaxError, ValueError):
        return set(), set()
    reads, binds = set[str](), set[str]()
    top = codes[0]
    while codes:
        code = codes.pop()
        steps = list(dis.get_instructions(code))
        reads |= {str(step.argval) for step in steps if step.opname in _READS}
        if code is top:
            binds = {str(step.argval) for step in steps if step.opname in _BINDS}
        codes += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
    return reads, binds


def load_ipython_extension(shell: Any) -> None:
    """Explain a ``NameError`` in a new kernel of ``./course lab``. IPython calls this when the kernel starts.

    The notebook's first cell imports ``autograder.notebook``, whose own messages about errors replace this explanation.
    """
    if os.environ.get(NOTEBOOKS_VARIABLE):
        shell.set_custom_exc((NameError,), _show)


def _show(shell: Any, kind: type, error: NameError, trace: Any, tb_offset: Any = None) -> None:
    del kind, tb_offset
    if trace.tb_next is not None and trace.tb_next.tb_next is None:  # the cell itself raised the error
        words = _ADVICE.format(error.name)
        error._render_traceback_ = lambda: [words]  # type: ignore[attr-defined]
    shell.showtraceback(running_compiled_code=True)
