"""The substitutions that a launch file can use."""

from __future__ import annotations

import os
import shlex
from typing import TYPE_CHECKING, Any

from .substitution import (
    SomeSubstitutionsType,
    Substitution,
    SubstitutionFailure,
    TextSubstitution,
    describe,
    normalize,
    perform,
)
from .typed import truth
from .unsupported import names_elsewhere

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .launch_context import LaunchContext

__all__ = [
    "AndSubstitution",
    "AnonName",
    "Command",
    "EnvironmentVariable",
    "EqualsSubstitution",
    "FileContent",
    "FindExecutable",
    "IfElseSubstitution",
    "LaunchConfiguration",
    "NotEqualsSubstitution",
    "NotSubstitution",
    "OrSubstitution",
    "PathJoinSubstitution",
    "PythonExpression",
    "SubstitutionFailure",
    "TextSubstitution",
    "ThisLaunchFile",
    "ThisLaunchFileDir",
]
__getattr__ = names_elsewhere(
    "launch.substitutions", ("AllSubstitution", "AnySubstitution", "LaunchLogDir", "LocalSubstitution")
)


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: SomeSubstitutionsType, *, default: Any = None) -> None:
        self.variable_name = normalize(variable_name)
        if default is None:
            self._default = None
        elif isinstance(default, str | Substitution | list | tuple):
            self._default = normalize(default)
        else:
            self._default = normalize(str(default))

    def describe(self) -> str:
        """Return `LaunchConfig('name')`."""
        return f"LaunchConfig({describe(self.variable_name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the value, or the default."""
        name = perform(context, self.variable_name)
        if name in context.launch_configurations:
            return context.launch_configurations[name]
        if self._default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return perform(context, self._default)


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(
        self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None
    ) -> None:
        self.name = normalize(name)
        self._default = None if default_value is None else normalize(default_value)

    def describe(self) -> str:
        """Return `EnvVar('NAME')`."""
        return f"EnvVar({describe(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the value, or the default."""
        name = perform(context, self.name)
        if name in context.environment:
            return context.environment[name]
        if self._default is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return perform(context, self._default)


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined by slashes."""

    def __init__(self, substitutions: Iterable[SomeSubstitutionsType]) -> None:
        self._parts = [normalize(part) for part in substitutions]

    def describe(self) -> str:
        """Return `PathJoin('a' + 'b')`."""
        return f"PathJoin('{' + '.join(describe(part) for part in self._parts)}')"

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        return os.path.join(*(perform(context, part) for part in self._parts))  # noqa: PTH118 (texts, not files)


class PythonExpression(Substitution):
    """The value of a Python expression, as text."""

    def __init__(
        self, expression: SomeSubstitutionsType, python_modules: SomeSubstitutionsType = ("math",)
    ) -> None:
        self._expression = normalize(expression)
        self._modules = normalize(python_modules)

    def describe(self) -> str:
        """Return `PythonExpr('1 + 1', ['math'])`."""
        modules = ", ".join(module.describe() for module in self._modules)
        return f"PythonExpr({describe(self._expression)}, [{modules}])"

    def perform(self, context: LaunchContext) -> str:
        """Evaluate the expression. It is part of a launch file, which is a program anyway."""
        import importlib

        names: dict[str, Any] = {}
        for part in self._modules:
            module = importlib.import_module(part.perform(context))
            if module.__name__ == "math":
                names.update(vars(module))
            names[module.__name__] = module
        expression = perform(context, self._expression)
        try:
            return str(eval(expression, {}, names))
        except Exception as error:
            raise SubstitutionFailure(f"'{expression}' can not be evaluated: {error}") from error


class Command(Substitution):
    """The output of a command."""

    def __init__(self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail") -> None:
        self._command = normalize(command)
        self._on_stderr = normalize(on_stderr)

    def describe(self) -> str:
        """Return `Command('xacro robot.xacro')`."""
        return f"Command({describe(self._command)})"

    def perform(self, context: LaunchContext) -> str:
        """Run the command and return its output."""
        import subprocess

        command, mode = perform(context, self._command), perform(context, self._on_stderr)
        if mode not in ("fail", "ignore", "warn", "capture"):
            raise SubstitutionFailure(
                "expected 'on_stderr' to be one of: 'fail', 'ignore', 'warn' or 'capture'"
            )
        stderr = subprocess.STDOUT if mode == "capture" else subprocess.PIPE
        try:
            done = subprocess.run(
                shlex.split(command), stdout=subprocess.PIPE, stderr=stderr, text=True, check=False
            )
        except OSError as error:
            raise SubstitutionFailure(f"file not found: {error}") from error
        if done.returncode != 0:
            raise SubstitutionFailure(f"executed command failed. Command: {command}\n{done.stderr or ''}")
        if done.stderr and mode in ("fail", "warn"):
            message = f"executed command showed stderr output. Command: {command}\n{done.stderr}"
            if mode == "fail":
                raise SubstitutionFailure(message)
            context.screen.log("WARNING", "launch", message)
        return done.stdout


class FindExecutable(Substitution):
    """The path of a program on PATH."""

    def __init__(self, *, name: SomeSubstitutionsType) -> None:
        self._name = normalize(name)

    def describe(self) -> str:
        """Return `FindExec('name')`."""
        return f"FindExec({describe(self._name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        import shutil

        name = perform(context, self._name)
        found = shutil.which(name, path=context.environment.get("PATH"))
        if found is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        return found


class FileContent(Substitution):
    """The text of a file."""

    def __init__(self, path: SomeSubstitutionsType) -> None:
        self._path = normalize(path)

    def describe(self) -> str:
        """Return `FileContent('path')`."""
        return f"FileContent({describe(self._path)})"

    def perform(self, context: LaunchContext) -> str:
        """Read the file."""
        path = perform(context, self._path)
        try:
            with open(path, encoding="utf-8") as file:  # noqa: PTH123 (pathlib costs start-up time)
                return file.read()
        except FileNotFoundError:
            raise SubstitutionFailure(f"File not found: {path}") from None


class ThisLaunchFile(Substitution):
    """The path of the launch file that is being read."""

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        if context.current_launch_file is None:
            raise SubstitutionFailure("ThisLaunchFile used outside of a launch file (in a script)")
        return context.current_launch_file


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file that is being read."""

    def perform(self, context: LaunchContext) -> str:
        """Return the folder."""
        if context.current_launch_file is None:
            raise SubstitutionFailure("ThisLaunchFileDir used outside of a launch file (in a script)")
        return os.path.dirname(context.current_launch_file)  # noqa: PTH120


class AnonName(Substitution):
    """A name that no other launch uses. The same id always gives the same name."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        self._name = normalize(name)

    def describe(self) -> str:
        """Return `AnonName('name')`."""
        return f"AnonName({describe(self._name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the name."""
        import random
        import socket

        name = perform(context, self._name)
        if f"anon{name}" not in context.launch_configurations:
            text = f"{name}_{socket.gethostname()}_{os.getpid()}_{random.getrandbits(63)}"
            context.launch_configurations[f"anon{name}"] = "".join(
                character if character.isalnum() else "_" for character in text
            )
        return context.launch_configurations[f"anon{name}"]


class NotSubstitution(Substitution):
    """The opposite of a truth value."""

    def __init__(self, value: SomeSubstitutionsType) -> None:
        self._value = normalize(value)

    def perform(self, context: LaunchContext) -> str:
        """Return true or false."""
        return str(not truth(perform(context, self._value))).lower()


class _Pair(Substitution):
    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        self._left, self._right = normalize(left), normalize(right)

    def describe(self) -> str:
        """Return the name of the class with both sides."""
        return f"{type(self).__name__}({describe(self._left)} {describe(self._right)})"

    def values(self, context: LaunchContext) -> tuple[str, str]:
        """Return the values of both sides."""
        return perform(context, self._left), perform(context, self._right)


class AndSubstitution(_Pair):
    """True if both are true."""

    def perform(self, context: LaunchContext) -> str:
        """Return true or false."""
        return str(all(map(truth, self.values(context)))).lower()


class OrSubstitution(_Pair):
    """True if one is true."""

    def perform(self, context: LaunchContext) -> str:
        """Return true or false."""
        return str(any(map(truth, self.values(context)))).lower()


class EqualsSubstitution(_Pair):
    """True if two texts are equal."""

    def perform(self, context: LaunchContext) -> str:
        """Return true or false."""
        left, right = self.values(context)
        return str(left == right).lower()


class NotEqualsSubstitution(_Pair):
    """True if two texts differ."""

    def perform(self, context: LaunchContext) -> str:
        """Return true or false."""
        left, right = self.values(context)
        return str(left != right).lower()


class IfElseSubstitution(Substitution):
    """One of two texts, chosen by a condition."""

    def __init__(
        self,
        condition: SomeSubstitutionsType,
        if_value: SomeSubstitutionsType = "",
        else_value: SomeSubstitutionsType = "",
    ) -> None:
        self._condition = normalize(condition)
        self._if, self._else = normalize(if_value), normalize(else_value)

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        return perform(context, self._if if truth(perform(context, self._condition)) else self._else)
