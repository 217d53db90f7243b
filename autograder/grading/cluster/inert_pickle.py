"""A stand-in for ``pickle.loads`` that makes plain values and inert exceptions, and runs nothing.

Dask's client unpickles more than results: the type of each result, errors, warnings. Whoever writes such a pickle
chooses which function is called with which arguments. :func:`install` takes that choice away for the whole process;
it belongs into a process that does nothing else than to speak with a cluster.

The way is the one that the documentation of :mod:`pickle` names under "Restricting Globals".
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
    """A stand-in for an object whose class was not made here. Its class has the name of the one that was meant."""

    def __call__(self, *_: Any, **__: Any) -> Any:
        """Nothing happens."""
        return self


class _InertUnpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        """A plain type, or something harmless under that name; nothing is imported."""
        if module == "builtins" and name in _PLAIN:
            return getattr(builtins, name)
        # Under these two names tblib, which Dask brings along, writes errors.
        if name == "unpickle_traceback":
            return _no_traceback
        if name.startswith("unpickle_exception"):
            return _exception
        return type(name, (Inert,), {"__module__": module})

    def persistent_load(self, _: Any) -> Any:
        """Nothing stands for itself here."""
        return None


def loads(data: Any, /, *, buffers: Iterable[Any] | None = None, **_: Any) -> Any:
    """Read a pickle without running anything; takes the arguments of :func:`pickle.loads`.

    Raises:
        Exception: It is no pickle, or asks for what plain values and inert objects do not do.
    """
    return _InertUnpickler(io.BytesIO(data), buffers=buffers).load()


def install() -> None:
    """Put it in the place of pickle's own functions, in this process, before anything else has fetched those."""
    replaced: Any = pickle
    replaced.loads = loads
    replaced.load = lambda file, **options: loads(file.read(), **options)
    replaced.Unpickler = _InertUnpickler


def _no_traceback(*_: Any) -> None:
    return None


def _exception(kind: Any, *said: Any) -> Any:
    """An error with its words, from what tblib keeps of it."""
    if not (isinstance(kind, type) and issubclass(kind, Inert)):
        return Inert()
    for part in said:
        if isinstance(part, dict) and isinstance(part.get("args"), tuple):
            return kind(*part["args"])
    return kind(*said[0]) if said and isinstance(said[0], tuple) else kind()
