"""Reads launch files in Python, XML and YAML."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from .substitution import SomeSubstitutionsType, describe, normalize, perform

if TYPE_CHECKING:
    from collections.abc import Callable

    from .launch_context import LaunchContext
    from .launch_description import LaunchDescription

__all__ = [
    "AnyLaunchDescriptionSource",
    "FrontendLaunchDescriptionSource",
    "InvalidLaunchFileError",
    "InvalidPythonLaunchFileError",
    "LaunchDescriptionSource",
    "PythonLaunchDescriptionSource",
    "get_launch_description_from_any_launch_file",
    "get_launch_description_from_frontend_launch_file",
    "get_launch_description_from_python_launch_file",
]

# The reader of XML and YAML makes actions, and one of these actions reads launch files. So the package sets this
# reader here.
frontend: Callable[[str], LaunchDescription] | None = None

_FUNCTION = "generate_launch_description"


class InvalidLaunchFileError(Exception):
    """A launch file cannot be read."""

    def __init__(self, extension: str = "", *, likely_errors: list[Exception] | None = None) -> None:
        errors = likely_errors or []
        if not extension or not errors:
            super().__init__("The launch file may have a syntax error, or its format is unknown")
            return
        several = "multiple exceptions" if len(errors) > 1 else "exception"
        lines = [f"Caught {several} when trying to load file of format [{extension}]:"]
        lines += [f" - {type(error).__name__}: {_with_place(error)}" for error in errors]
        super().__init__("\n".join(lines))
        self.__cause__ = errors[0]


class InvalidPythonLaunchFileError(Exception):
    """A Python launch file has no function to call."""


def _with_place(error: Exception) -> str:
    """Return the text of an error, with the line of the launch file that raised it."""
    import traceback

    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.name != "_load_python"]
    here = os.path.dirname(__file__)  # noqa: PTH120
    own = [f for f in frames if not f.filename.startswith((here, "<frozen"))]
    if not own or isinstance(error, SyntaxError):
        return str(error)
    return f"{error} ({os.path.basename(own[-1].filename)}, line {own[-1].lineno})"  # noqa: PTH119


def _load_python(path: str) -> Any:
    """Run a Python launch file and return its module."""
    import importlib.machinery
    import importlib.util

    loader = importlib.machinery.SourceFileLoader("python_launch_file", path)
    spec = importlib.util.spec_from_file_location(loader.name, path, loader=loader)
    if spec is None:
        raise InvalidLaunchFileError
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def get_launch_description_from_python_launch_file(path: str) -> LaunchDescription:
    """Return what `generate_launch_description()` of a Python file returns.

    Raises:
        InvalidPythonLaunchFileError: The function does not exist, or does not return a launch description.
        Exception: Any exception that the file itself raises.
    """
    from .launch_description import LaunchDescription

    module = _load_python(path)
    if not hasattr(module, _FUNCTION):
        raise InvalidPythonLaunchFileError(
            f"launch file at '{path}' does not contain the required function '{_FUNCTION}()'"
        )
    description = getattr(module, _FUNCTION)()
    if not isinstance(description, LaunchDescription):
        raise InvalidPythonLaunchFileError(
            f"'{_FUNCTION}()' in '{path}' must return a LaunchDescription, not {description!r}"
        )
    return description


def get_launch_description_from_frontend_launch_file(path: str) -> LaunchDescription:
    """Return the launch description of an XML or YAML file."""
    assert frontend is not None
    return frontend(path)


def get_launch_description_from_any_launch_file(path: str) -> LaunchDescription:
    """Read a launch file of any kind. The extension of its name decides the kind.

    Raises:
        InvalidLaunchFileError: The file cannot be read.
    """
    extension = os.path.splitext(path)[1].lstrip(".")  # noqa: PTH122
    readers: list[Callable[[str], LaunchDescription]] = [
        get_launch_description_from_python_launch_file,
        get_launch_description_from_frontend_launch_file,
    ]
    if extension == "py":
        readers = readers[:1]
    elif extension in ("xml", "yaml", "yml", "launch"):
        readers = readers[1:]
    else:
        extension = ""
    errors: list[Exception] = []
    for reader in readers:
        try:
            return reader(path)
        except Exception as error:
            errors.append(error)
    raise InvalidLaunchFileError(extension, likely_errors=errors)


class LaunchDescriptionSource:
    """The source of a launch description."""

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: SomeSubstitutionsType = "<script>",
        method: str = "unspecified mechanism from a script",
    ) -> None:
        self._description = launch_description
        self._location = normalize(location)
        self._path: str | None = None
        self.method = method

    @property
    def location(self) -> str:
        """The path of the launch file; while it is unknown, a description of how it will be made."""
        return describe(self._location) if self._path is None else self._path

    def _read(self, path: str) -> LaunchDescription:
        raise RuntimeError(f"nothing is known of how to read '{path}'")

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the launch description. The first call reads it."""
        if self._path is None:
            self._path = perform(context, self._location)
        if self._description is None:
            self._description = self._read(self._path)
        return self._description

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """Return the description if that is possible before the launch runs, else None."""
        from .launch_context import LaunchContext

        try:
            return self.get_launch_description(LaunchContext())
        except Exception:
            # An error will be reported when the launch runs.
            return None


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file of any kind."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted launch file")

    def _read(self, path: str) -> LaunchDescription:
        return get_launch_description_from_any_launch_file(path)


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A Python launch file."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted python launch file")

    def _read(self, path: str) -> LaunchDescription:
        return get_launch_description_from_python_launch_file(path)


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """An XML or YAML launch file."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted frontend launch file")

    def _read(self, path: str) -> LaunchDescription:
        return get_launch_description_from_frontend_launch_file(path)
