"""Say clearly what only the full launch has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from collections.abc import Callable

FULL = "the full launch of a ROS 2 Jazzy installation"


def names_elsewhere(module: str, names: tuple[str, ...]) -> Callable[[str], NoReturn]:
    """Return a module's `__getattr__` for names that Jazzy's module of that name has and this one has not."""

    def missing(name: str) -> NoReturn:
        if name in names:
            raise ImportError(f"{module}.{name} needs {FULL}: the course's own launch does not have it")
        raise AttributeError(f"module '{module}' has no attribute '{name}'")

    return missing


def refuse_arguments(owner: str, given: dict[str, Any], elsewhere: tuple[str, ...] = ()) -> None:
    """Raise an error for keyword arguments that were not used.

    Args:
        owner: the name of the class.
        given: the arguments that are left over.
        elsewhere: names that Jazzy's class takes.

    Raises:
        TypeError: there is at least one.
    """
    for name in given:
        if name in elsewhere:
            raise TypeError(f"{owner}({name}=…) needs {FULL}: the course's own launch does not have it")
        raise TypeError(f"{owner}() got an unexpected keyword argument '{name}'")
