"""Reports clearly what only the full launch has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from collections.abc import Callable

FULL = "the full launch of a ROS 2 Jazzy installation"


def names_elsewhere(module: str, names: tuple[str, ...]) -> Callable[[str], NoReturn]:
    """Return a module's `__getattr__` for names that exist in Jazzy's module and not in this one."""

    def missing(name: str) -> NoReturn:
        if name in names:
            raise ImportError(f"{module}.{name} needs {FULL}: the course's own launch does not have it")
        raise AttributeError(f"module '{module}' has no attribute '{name}'")

    return missing


def refuse_arguments(owner: str, given: dict[str, Any], elsewhere: tuple[str, ...] = ()) -> None:
    """Raise an error for keyword arguments that were not used.

    Args:
        owner: The name of the class.
        given: The arguments that were not used.
        elsewhere: The names of arguments that Jazzy's class accepts.

    Raises:
        TypeError: There is such an argument.
    """
    for name in given:
        if name in elsewhere:
            raise TypeError(f"{owner}({name}=…) needs {FULL}: the course's own launch does not have it")
        raise TypeError(f"{owner}() got an unexpected keyword argument '{name}'")
