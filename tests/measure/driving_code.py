"""Finds the code that drives a subject: what a function refers to, directly or through others, without its words.

A function counts with everything that it names. A class counts with its fields, and with those methods whose names are
used anywhere in the code that was found, since nothing says which object a name is asked of. So more may be found than
runs, and never less. Words do not count: docstrings, comments, annotations, imports, decorators of functions, messages
of errors, and the texts of findings and advice.
"""

from __future__ import annotations

import ast
import functools
import sys
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import FunctionType, MethodType, ModuleType
from typing import TYPE_CHECKING, Any

from autograder import course, exercises
from autograder.kit.model import Exercise

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

OURS = ("autograder.kit.", "autograder.judge.", "autograder.robot.", "autograder.workspaces.")
"""The beginnings of the names of modules that drive a subject, next to the modules of the labs."""
SPEAKS = ("autograder.judge.timeline.", "autograder.judge.evidence_files.")
"""The beginnings of the names of modules that only say or keep what was seen."""
WORDS = {"Finding": 1, "Advice": 0, "Mistake": 0, "Diagnosis": 0}
"""The classes that carry words for a card, each with the number of its first arguments that are no words."""
SHOWS = ("__str__", "__repr__", "__format__")
"""The special methods that make words."""


class DrivingCode:
    """The code that some functions and modules refer to."""

    def __init__(self) -> None:
        self._texts: set[str] = set()
        self._asked: set[str] = set()
        self._classes: list[type] = []
        self._known: dict[tuple[int, int, str], tuple[Any, Any]] = {}

    def texts(self) -> list[str]:
        """Return the text of each function, class and constant, sorted."""
        found = -1
        while found != len(self._known):  # a method that is added may use the name of another one
            found = len(self._known)
            for one in self._classes:  # which grows
                self._add_methods(one)
        return sorted(self._texts)

    def add_module(self, module: ModuleType) -> None:
        """Add every function and class that a module defines."""
        for value in vars(module).values():
            if isinstance(value, (type, FunctionType)) and value.__module__ == module.__name__:
                self.add(value)

    def add(self, value: Any, name: str = "", owner: Any = None) -> None:
        """Add a value with everything that it refers to.

        Args:
            value: A function, a class, data, or an object of the kit.
            name: The name by which the value was found.
            owner: The object that a function calls ``self``.
        """
        key = id(value), id(owner), "" if callable(value) else name
        if key in self._known:
            return
        self._known[key] = value, owner  # kept alive, so that no other value gets its id
        if isinstance(value, MethodType):
            self.add(value.__func__, name, value.__self__)
        elif isinstance(value, FunctionType):
            self._add_function(value, owner)
        elif isinstance(value, type):
            if _is_ours(value.__module__) and not issubclass(value, Enum):
                self._add_code(value, vars(sys.modules[value.__module__]), None)
                self._classes.append(value)
        elif (inner := _inside(value)) is not None:
            for part in inner:
                self.add(part, name, owner)
        else:
            self._texts.add(f"{name} = {_word(value)}")

    def _add_methods(self, owner: type) -> None:
        for name, member in list(vars(owner).items()):
            is_special = name.startswith("__") and name.endswith("__") and name not in SHOWS
            if is_special or name in self._asked:
                for part in _inside(member) or (member,):
                    if isinstance(part, FunctionType):
                        self.add(part, name)

    def _add_function(self, function: FunctionType, owner: Any) -> None:
        if hasattr(function, "__wrapped__"):
            self.add(function.__wrapped__, owner=owner)
        if _is_ours(function.__globals__["__name__"]):
            names = dict(function.__globals__)
            for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
                names[name] = cell.cell_contents
            self._add_code(function, names, owner)

    def _add_code(self, value: Any, names: Mapping[str, Any], owner: Any) -> None:
        piece = _piece(value)
        if piece is None:
            return  # made by another program, such as a dataclass's __init__: what it was made of counts
        # Without its module: where something is written changes nothing that is seen.
        self._texts.add(f"{value.__qualname__}: {piece.text}")
        used = {name: names[name] for name in piece.names if name in names}
        attributes = piece.attributes
        self._asked |= attributes
        for name, found in used.items():
            if not _has_parts(found):
                self.add(found, name)
        wholes = [whole for whole in (owner, *used.values()) if _has_parts(whole)]
        for whole in wholes:  # which grows
            for name in attributes:
                for found in _attributes(whole, name):
                    if not _has_parts(found):
                        self.add(found, name, whole)
                    elif not any(found is other for other in wholes):
                        wholes.append(found)


def _attributes(whole: Any, name: str) -> list[Any]:
    """Return what an attribute of an object is, or may be: also what a subclass has instead of it."""
    places = [whole, *type(whole).__mro__] if not isinstance(whole, ModuleType) else [whole]
    return [vars(place)[name] for place in places if name in getattr(place, "__dict__", ())]


def _inside(value: Any) -> Sequence[Any] | None:
    """Return the parts of a value, in an order that is always the same; None if the value is plain."""
    if isinstance(value, Exercise):  # one that is a part of another; criteria decide nothing there
        return value.scenario, value.runner
    if isinstance(value, property):
        return (value.fget,)
    if isinstance(value, functools.cached_property):
        return (value.func,)
    if isinstance(value, functools.partial):
        return value.func, value.args, value.keywords
    if hasattr(value, "__wrapped__") and not isinstance(value, FunctionType):
        return (value.__wrapped__,)
    if isinstance(value, dict):
        return [item for pair in value.items() for item in pair]
    if isinstance(value, (list, tuple)):
        return str(list(map(_word, value))), *value
    if is_dataclass(value) and not isinstance(value, type):
        return type(value), [getattr(value, field.name) for field in fields(value)]
    return None


def _has_parts(value: Any) -> bool:
    """Return True if only those attributes of an object count that are named: a module, a recipe."""
    if isinstance(value, ModuleType):
        return _is_ours(value.__name__)
    plain = isinstance(value, (type, FunctionType, Enum)) or is_dataclass(value)
    return not plain and _is_ours(type(value).__module__)


def _is_ours(module: str) -> bool:
    if f"{module}.".startswith(SPEAKS):
        return False
    return f"{module}.".startswith(OURS) or module.partition(".")[0] in _labs()


@functools.cache
def _labs() -> frozenset[str]:
    return frozenset(exercise_id.partition(".")[0] for exercise_id in exercises.all_ids())


@functools.cache
def _course() -> str:
    return str(course.root())  # which looks at the disk


def _word(value: Any) -> str:
    if isinstance(value, (set, frozenset)):
        return str(sorted(map(_word, value)))
    if isinstance(value, str):
        return repr(value.replace(_course(), "/course"))
    if value is None or isinstance(value, (bytes, int, float)):
        return repr(value)
    name = getattr(value, "__qualname__", type(value).__qualname__)
    return f"{name} {getattr(value, 'pattern', '')}"


@dataclass(frozen=True)
class _Piece:
    """The code of a function or a class.

    Attributes:
        text: The code.
        names: The names that it uses, in the order of the code.
        attributes: The names of the attributes that it uses.
    """

    text: str
    names: tuple[str, ...]
    attributes: frozenset[str]


def _piece(value: Any) -> _Piece | None:
    """Return the code that a function or class was made of; None if it is written in no file."""
    if isinstance(value, type):
        return _pieces(sys.modules[value.__module__].__file__ or "").get(value.__qualname__)
    code = value.__code__
    if not Path(code.co_filename).is_file():
        return None
    kind = "lambda" if value.__name__ == "<lambda>" else "def"
    return _pieces(code.co_filename)[f"{kind} {code.co_firstlineno}"]


@functools.cache
def _pieces(file: str) -> dict[str, _Piece]:
    """Return the functions of a file by their first lines, the lambdas of a line together, and the classes by name.

    Each is without its words, and a class without its methods.
    """
    nodes: dict[str, ast.AST] = {}
    for node, name in _named(ast.parse(Path(file).read_text(encoding="utf-8")), ""):
        if isinstance(node, ast.ClassDef):
            nodes[name] = node
        elif isinstance(node, ast.Lambda):
            others = nodes.setdefault(f"lambda {node.lineno}", ast.Tuple([], ast.Load()))
            assert isinstance(others, ast.Tuple)
            others.elts.append(node)
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            nodes[f"def {min((node.lineno, *(one.lineno for one in node.decorator_list)))}"] = node
    # A class last, since its methods are taken out of the tree.
    inner_first = sorted(nodes, key=lambda key: isinstance(nodes[key], ast.ClassDef))
    return {key: _piece_of(_Plain().visit(nodes[key])) for key in inner_first}


def _piece_of(node: ast.AST) -> _Piece:
    inner = list(ast.walk(node))
    names = dict.fromkeys(one.id for one in inner if isinstance(one, ast.Name))
    attributes = frozenset(one.attr for one in inner if isinstance(one, ast.Attribute))
    return _Piece(ast.unparse(node), tuple(names), attributes)


def _named(node: ast.AST, inside: str) -> Iterator[tuple[ast.AST, str]]:
    for child in ast.iter_child_nodes(node):
        name = f"{inside}{getattr(child, 'name', '')}"
        yield child, name
        deeper = {ast.ClassDef: f"{name}.", ast.FunctionDef: f"{name}.<locals>."}.get(type(child), inside)
        yield from _named(child, deeper)


class _Plain(ast.NodeTransformer):
    """Takes the words out of code, and the methods out of a class, unless a function contains it."""

    _in_a_function = False

    def visit_Import(self, node: ast.Import) -> None:
        """Take it out: where a name comes from changes nothing that is seen."""

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        """Take it out, too."""

    def visit_FunctionDef(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> ast.AST:
        """Keep the code of a function: its decorators and annotations contain words, or nothing that runs."""
        node.decorator_list, node.returns = [], None
        outside, self._in_a_function = self._in_a_function, True
        self._without_docstring(node)
        self._in_a_function = outside
        return node

    def visit_AsyncFunctionDef(self, node: ast.AsyncFunctionDef) -> ast.AST:
        """Do the same with a coroutine."""
        return self.visit_FunctionDef(node)

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        """Keep the fields of a class: each of its methods counts for itself."""
        methods = () if self._in_a_function else (ast.FunctionDef, ast.AsyncFunctionDef)
        node.body = [one for one in node.body if not isinstance(one, methods)]
        self._without_docstring(node)
        return node

    def visit_arg(self, node: ast.arg) -> ast.AST:
        """Keep the name of a parameter, and not its annotation."""
        node.annotation = None
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        """Keep the name and the value: of a field's annotation only its presence counts."""
        self.generic_visit(node)
        node.annotation = ast.Constant(None)
        return node

    def visit_Raise(self, node: ast.Raise) -> ast.AST:
        """Keep the error without its message."""
        if isinstance(node.exc, ast.Call):
            node.exc.args = [one for one in node.exc.args if not _is_message(one)]
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Keep what decides of a finding, and not its words."""
        if isinstance(node.func, ast.Name) and node.func.id in WORDS:
            node.args, node.keywords = node.args[: WORDS[node.func.id]], []
        return self.generic_visit(node)

    def _without_docstring(self, node: Any) -> None:
        node.body = [one for one in node.body if not _is_text(one)]
        self.generic_visit(node)
        node.body = node.body or [ast.Pass()]


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _is_message(node: ast.expr) -> bool:
    """Return True for a text, also one that is put together of texts."""
    if isinstance(node, ast.BinOp):
        return _is_message(node.left)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        return _is_message(node.func.value)
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))
