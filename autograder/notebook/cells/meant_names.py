"""Suggest the name that a student may have meant, as Python does when an error ends a program."""

from __future__ import annotations

import builtins
import difflib
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import TracebackType

_NEAR = 0.75
"""The minimum similarity of two names, from 0 to 1, for a suggestion. For ``sefl`` and ``self`` it is 0.75."""


def meant_name(error: BaseException, trace: TracebackType | None) -> str:
    """Return a text such as ``. Did you mean: 'command'?``; empty if no name is similar or Python itself suggests one.

    From Python 3.12 on, ``traceback`` adds the suggestion. In Python 3.11 the interpreter adds it, but only if the
    error ends a program.

    Args:
        error: A NameError or an AttributeError; there is no suggestion for other errors.
        trace: The traceback of the error.
    """
    missing = getattr(error, "name", None)
    if sys.version_info >= (3, 12) or not missing or not isinstance(error, (NameError, AttributeError)):
        return ""
    if isinstance(error, AttributeError):
        known = _attributes(error.obj)
    else:
        while trace is not None and trace.tb_next is not None:
            trace = trace.tb_next
        local = trace.tb_frame.f_locals if trace is not None else {}
        if missing in _attributes(local.get("self")):
            return f". Did you mean: 'self.{missing}'?"
        known = [*local, *(trace.tb_frame.f_globals if trace is not None else {}), *dir(builtins)]
    public = [name for name in known if name[:1] != "_"]
    same = [name for name in public if name.lower() == missing.lower()]
    near = same or difflib.get_close_matches(missing, public, 1, _NEAR)
    return f". Did you mean: '{near[0]}'?" if near else ""


def _attributes(value: object) -> list[str]:
    """Return the names of a value's attributes, without calling a ``__dir__`` of its class."""
    return [*dir(type(value)), *getattr(value, "__dict__", {})]
