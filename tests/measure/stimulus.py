"""A digest of all that decides on what a judge sees of an answer, and of nothing that decides what it says of that.

It is made of the bench of the judge, the reference output, and the scenario with every function, class and constant of
the kit and of the labs that it refers to, directly or through others. Criteria, diagnoses and words change without it
wherever the scenario does not ask them. Comments and docstrings do not count.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import sys
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import FunctionType, MethodType, ModuleType
from typing import TYPE_CHECKING, Any

import autograder
from autograder import exercises
from autograder.judge import evidence_files, one_check
from autograder.kit.model import Exercise

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

PACKAGE = Path(autograder.__file__).parent
JUDGE = (
    "judge/bench",
    *(f"judge/{name}.py" for name in ("subject", "notebook_subject", "path_subject", "command_check")),
    *(f"judge/{name}.py" for name in ("ros_setup", "machine_fitness")),
    "judge/fastdds_profile.xml",
    "kit/evidence.py",
)
"""What is behind the words of a scenario, for each exercise."""
WORKSPACES = ("workspaces",)
"""What runs the subject of an exercise that has a runner."""


@functools.cache
def digest(exercise_id: str) -> str:
    """The SHA-256 of all that the evidence of an exercise's answers depends on, the answers aside.

    Raises:
        UnknownExercise: There is no such exercise.
        BrokenExercise: It cannot be imported.
        NoReference: It was never recorded.
    """
    exercise = exercises.get(exercise_id)
    reached = _Reached()
    reached.add(exercise.scenario)
    reached.add(exercise.runner)
    said = [
        evidence_files.reference_digest(exercise_id),
        repr((exercise.second_look, exercise.limit)),
        _plain(_nodes(one_check.__file__)[f"def {one_check.look.__code__.co_firstlineno}"]),
        *_files(JUDGE + (WORKSPACES if exercise.runner else ())),
        *sorted(reached.texts),
    ]
    return hashlib.sha256("\0".join(said).encode()).hexdigest()


@functools.cache
def _files(names: Iterable[str]) -> list[str]:
    found = []
    for name in names:
        path = PACKAGE / name
        for file in sorted(path.rglob("*.*")) if path.is_dir() else [path]:
            if file.suffix != ".pyc":
                text = file.read_text(encoding="utf-8")
                found.append(_plain(ast.parse(text)) if file.suffix == ".py" else text)
    return found


class _Reached:
    """The texts of functions, classes and data of the kit and the labs, reached from one of them by name.

    Attributes:
        texts: One for each.
    """

    def __init__(self) -> None:
        self.texts: set[str] = set()
        self._known: dict[tuple[int, int, str], tuple[Any, Any]] = {}

    def add(self, value: Any, name: str = "", owner: Any = None) -> None:
        """Add a value with all that it refers to.

        Args:
            value: Anything.
            name: What it is called where it was found.
            owner: What a function calls ``self``.
        """
        key = id(value), id(owner), "" if callable(value) else name
        if key in self._known:
            return
        self._known[key] = value, owner  # kept alive, so that no other one gets its id
        if isinstance(value, MethodType):
            self.add(value.__func__, name, value.__self__)
        elif isinstance(value, FunctionType):
            self._add_function(value, owner)
        elif isinstance(value, type):
            if _is_ours(value.__module__) and not issubclass(value, Enum):
                self._add_code(value, vars(sys.modules[value.__module__]), None)
        elif (inner := _inside(value)) is not None:
            for part in inner:
                self.add(part, name, owner)
        else:
            self.texts.add(f"{name} = {_word(value)}")

    def _add_function(self, function: FunctionType, owner: Any) -> None:
        if hasattr(function, "__wrapped__"):
            self.add(function.__wrapped__, owner=owner)
        if _is_ours(function.__globals__["__name__"]):
            names = dict(function.__globals__)
            for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
                names[name] = cell.cell_contents
            self._add_code(function, names, owner)

    def _add_code(self, value: Any, names: dict[str, Any], owner: Any) -> None:
        node = _node(value)
        if node is None:
            return  # made by another program, such as a dataclass's __init__: what it was made of counts
        # Without its module: where something is written changes nothing that is seen.
        self.texts.add(f"{value.__qualname__}: {_plain(node)}")
        nodes = list(ast.walk(node))
        used = {one.id: names[one.id] for one in nodes if isinstance(one, ast.Name) and one.id in names}
        attributes = {one.attr for one in nodes if isinstance(one, ast.Attribute)}
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
    """What something is, or may be, by the name of an attribute: also what a subclass has in place of it."""
    places = [whole, *type(whole).__mro__] if not isinstance(whole, ModuleType) else [whole]
    return [vars(place)[name] for place in places if name in getattr(place, "__dict__", ())]


def _inside(value: Any) -> Sequence[Any] | None:
    """What a value is made of, in an order that is always the same; None where it is plain."""
    if isinstance(value, Exercise):  # one that is a part of another; criteria decide nothing there
        return value.scenario, value.runner
    if isinstance(value, property):
        return (value.fget,)
    if isinstance(value, functools.cached_property):
        return (value.func,)
    if isinstance(value, functools.partial):
        return value.func, value.args, value.keywords
    if hasattr(value, "__wrapped__"):
        return (value.__wrapped__,)
    if isinstance(value, dict):
        return [item for pair in value.items() for item in pair]
    if isinstance(value, (list, tuple)):
        return str(list(map(_word, value))), *value
    if is_dataclass(value):
        return type(value), [getattr(value, field.name) for field in fields(value)]
    return None


def _has_parts(value: Any) -> bool:
    """Whether only those of its attributes count that are named: a module, a recipe."""
    if isinstance(value, ModuleType):
        return _is_ours(value.__name__)
    plain = isinstance(value, (type, FunctionType, Enum)) or is_dataclass(value)
    return not plain and _is_ours(type(value).__module__)


def _is_ours(module: str) -> bool:
    return module.startswith("autograder.kit.") or module.partition(".")[0] in _labs()


@functools.cache
def _labs() -> frozenset[str]:
    return frozenset(exercise_id.partition(".")[0] for exercise_id in exercises.all_ids())


def _word(value: Any) -> str:
    if isinstance(value, (set, frozenset)):
        return str(sorted(map(_word, value)))
    if value is None or isinstance(value, (str, bytes, int, float)):
        return repr(value)
    name = getattr(value, "__qualname__", type(value).__qualname__)
    return f"{name} {getattr(value, 'pattern', '')}"


def _node(value: Any) -> ast.AST | None:
    """The piece of a syntax tree that a function or class was made of; None where it stands in no file."""
    if isinstance(value, type):
        return _nodes(sys.modules[value.__module__].__file__ or "").get(value.__qualname__)
    code = value.__code__
    if not Path(code.co_filename).is_file():
        return None
    return _nodes(code.co_filename)[
        f"{'lambda' if value.__name__ == '<lambda>' else 'def'} {code.co_firstlineno}"
    ]


@functools.cache
def _nodes(file: str) -> dict[str, ast.AST]:
    """Functions by their first line, lambdas in one line taken together, and classes by their names."""
    found: dict[str, ast.AST] = {}
    for node, name in _named(ast.parse(Path(file).read_text(encoding="utf-8")), ""):
        if isinstance(node, ast.ClassDef):
            found[name] = node
        elif isinstance(node, ast.Lambda):
            others = found.setdefault(f"lambda {node.lineno}", ast.Tuple([], ast.Load()))
            assert isinstance(others, ast.Tuple)
            others.elts.append(node)
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            found[f"def {min((node.lineno, *(one.lineno for one in node.decorator_list)))}"] = node
    return found


def _named(node: ast.AST, inside: str) -> Iterator[tuple[ast.AST, str]]:
    for child in ast.iter_child_nodes(node):
        name = f"{inside}{getattr(child, 'name', '')}"
        yield child, name
        deeper = {ast.ClassDef: f"{name}.", ast.FunctionDef: f"{name}.<locals>."}.get(type(child), inside)
        yield from _named(child, deeper)


class _Plain(ast.NodeTransformer):
    """Drops docstrings and the decorators of functions, in which texts for students stand."""

    def visit(self, node: ast.AST) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Module)):
            node.body = [one for one in node.body if not _is_text(one)] or [ast.Pass()]
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            node.decorator_list = []
        return node


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _plain(node: ast.AST) -> str:
    return ast.unparse(_Plain().visit(node))
