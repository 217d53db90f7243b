"""A replacement for ``pickle.loads`` that makes only plain values and inert exceptions, and runs no code.

A pickle can make its reader call any function, and Dask's client unpickles results, the types of results, errors and
warnings from workers. :func:`install` prevents such calls in the whole process. Because other code may need pickle's
own functions, use it only in a process that does nothing but communicate with a cluster.

The method is described in the documentation of :mod:`pickle` under "Restricting Globals".
"""

from __future__ import annotations

import builtins
import io
import pickle
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

_PLAIN = frozenset({"bool", "bytearray", "bytes", "complex", "dict", "float", "frozenset", "int", "list"})
_PLAIN |= {"set", "str", "tuple"}


class Inert(Exception):
    """Base class of the stand-ins for objects in a pickle. A stand-in's class has the real name, but no code."""

    def __call__(self, *_: Any, **__: Any) -> Any:
        """Do nothing."""
        return self


class _InertUnpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        """Return a plain type or, without importing anything, an inert stand-in with this name."""
        if module == "builtins" and name in _PLAIN:
            return getattr(builtins, name)
        # tblib, which Dask uses, stores errors under these two names.
        if name == "unpickle_traceback":
            return lambda *_: None
        if name.startswith("unpickle_exception"):
            return _exception
        return type(name, (Inert,), {"__module__": module})

    def persistent_load(self, _: Any) -> Any:
        """Return None: references to objects outside the pickle are not supported."""
        return None


def loads(data: Any, /, *, buffers: Iterable[Any] | None = None, **_: Any) -> Any:
    """Read a pickle without running anything from it. The arguments are those of :func:`pickle.loads`.

    Raises:
        Exception: The data is not a pickle, or needs more than plain values and inert stand-ins.
    """
    return _InertUnpickler(io.BytesIO(data), buffers=buffers).load()


def install() -> None:
    """Replace pickle's own functions in this process. Call this before any module imports the original functions."""
    replaced: Any = pickle
    replaced.loads = loads
    replaced.load = lambda file, **options: loads(file.read(), **options)
    replaced.Unpickler = _InertUnpickler


def _exception(kind: Any, *said: Any) -> Any:
    """Return an inert exception with the message that tblib stored in the pickle."""
    if not (isinstance(kind, type) and issubclass(kind, Inert)):
        return Inert()
    for part in said:
        if isinstance(part, dict) and isinstance(part.get("args"), tuple):
            return kind(*part["args"])
    return kind(*said[0]) if said and isinstance(said[0], tuple) else kind()
