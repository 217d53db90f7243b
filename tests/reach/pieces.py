"""The pieces of a Python file, and what each of them mentions.

A piece is a function, a class without its methods, a method, a variable of the module, or the rest of the file, which
runs when the file is imported.
"""

from __future__ import annotations

import ast
import contextlib
import re
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from tests.reach.imports import imports_in

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.reach.imports import Import

REST = ""
"""The name of the piece that runs when the file is imported."""
MAIN = "__main__"
"""The name of the piece that runs only when the file is started."""
Function = ast.FunctionDef | ast.AsyncFunctionDef
_WORD = re.compile(r"[A-Za-z_][\w-]*")


@dataclass
class Piece:
    """A piece of a file.

    Attributes:
        chains: The names that it mentions, with their attributes: ``outcomes.Outcome``.
        attributes: The attributes that it mentions of anything.
        strings: The strings in it.
        choices: Those of them among which the parameters of a test are chosen.
        started: The modules that it starts as programs.
        parameters: The names of a function's parameters.
        decorators: What its decorators are called, without their arguments.
        bases: The base classes of a class.
        is_everywhere: Whether it is a fixture that each test uses unasked.
        command: The word that runs it, for a command of the command line.
    """

    chains: set[str] = field(default_factory=set)
    attributes: set[str] = field(default_factory=set)
    strings: set[str] = field(default_factory=set)
    choices: set[str] = field(default_factory=set)
    started: set[str] = field(default_factory=set)
    parameters: set[str] = field(default_factory=set)
    decorators: set[str] = field(default_factory=set)
    bases: set[str] = field(default_factory=set)
    command: str = ""
    is_everywhere: bool = False

    @property
    def methods(self) -> set[str]:
        """The names of methods that it may mean."""
        return self.attributes | {text for text in self.strings if text.isidentifier()}

    @property
    def commands(self) -> set[str]:
        """The names of commands that it may mean."""
        return {word for text in self.strings for word in _WORD.findall(text)}


@dataclass(frozen=True)
class Source:
    """A file that was read.

    Attributes:
        pieces: By name; a method's is ``Class.method``.
        imports: Its imports.
    """

    pieces: dict[str, Piece]
    imports: tuple[Import, ...]


def read(text: str) -> Source:
    """Read the text of a Python file.

    Raises:
        SyntaxError: The text is not Python.
    """
    tree = ast.parse(text)
    pieces: dict[str, Piece] = defaultdict(Piece)
    pieces[REST] = Piece()
    for name, node in _named(tree):
        _Reader(pieces[name]).read(node)
    return Source(dict(pieces), imports_in(tree))


def texts(text: str) -> dict[str, str]:
    """Return the code of each piece, by its name, without comments and the docstrings that no decorator reads."""
    found: dict[str, str] = defaultdict(str)
    for name, node in _named(ast.parse(text)):
        found[name] += ast.dump(node)
    return dict(found)


def _named(tree: ast.Module) -> Iterator[tuple[str, ast.AST]]:
    for node in tree.body:
        if isinstance(node, Function):
            yield node.name, _without_docstring(node)
        elif isinstance(node, ast.ClassDef):
            methods = [one for one in node.body if isinstance(one, Function)]
            for method in methods:
                yield f"{node.name}.{method.name}", _without_docstring(method)
            node.body = [one for one in node.body if one not in methods]
            yield node.name, _without_docstring(node)
        elif names := _assigned(node):
            for name in names:
                yield name, node
        elif isinstance(node, ast.If) and MAIN in ast.unparse(node.test):
            yield MAIN, node
        elif (
            not isinstance(node, ast.Import | ast.ImportFrom)
            and not _is_text(node)
            and not _is_for_types(node)
        ):
            yield REST, node


def _assigned(node: ast.stmt) -> list[str]:
    targets = node.targets if isinstance(node, ast.Assign) else []
    if isinstance(node, ast.AnnAssign | ast.AugAssign):
        targets = [node.target]
    names = [one for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)]
    plain = all(isinstance(target, ast.Name | ast.Tuple | ast.List) for target in targets)
    return [one.id for one in names] if plain else []


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _is_for_types(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


def _without_docstring(node: Function | ast.ClassDef) -> ast.AST:
    if not node.decorator_list:  # a decorator may read it, as the help of a command
        node.body = [one for one in node.body if not _is_text(one)]
    return node


def _name_of(decorator: ast.expr) -> str:
    return ast.unparse(decorator.func if isinstance(decorator, ast.Call) else decorator)


class _Reader(ast.NodeVisitor):
    """Fills a piece with what a syntax tree mentions; types of parameters and results are not evaluated."""

    def __init__(self, piece: Piece) -> None:
        self.piece = piece

    def read(self, node: ast.AST) -> None:
        piece = self.piece
        if isinstance(node, Function | ast.ClassDef):
            piece.decorators |= {_name_of(one) for one in node.decorator_list}
        if isinstance(node, ast.ClassDef):
            piece.bases |= {_name_of(one) for one in node.bases}
        if isinstance(node, Function):
            arguments = node.args
            given = (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
            piece.parameters |= {one.arg for one in given}
            piece.is_everywhere = any("autouse=True" in ast.unparse(one) for one in node.decorator_list)
            for one in node.decorator_list:
                if isinstance(one, ast.Call) and _name_of(one).endswith(".command"):
                    texts = [word.value for word in one.args if isinstance(word, ast.Constant)]
                    piece.command = str(texts[0]) if texts else node.name.replace("_", "-")
        self.visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        self._visit_function(node)

    def visit_AsyncFunctionDef(self, node: ast.AsyncFunctionDef) -> None:
        self._visit_function(node)

    def _visit_function(self, node: Function) -> None:
        defaults = [*node.args.defaults, *(one for one in node.args.kw_defaults if one)]
        for decorator in node.decorator_list:
            if _name_of(decorator).endswith(".parametrize"):
                inside = Piece()
                _Reader(inside).visit(decorator)
                self.piece.choices |= inside.strings
            self.visit(decorator)
        for inner in (*defaults, *node.body):
            self.visit(inner)

    def visit_Name(self, node: ast.Name) -> None:
        self.piece.chains.add(node.id)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        self.piece.attributes.add(node.attr)
        names = [node.attr]
        value = node.value
        while isinstance(value, ast.Attribute):
            self.piece.attributes.add(value.attr)
            names.append(value.attr)
            value = value.value
        if isinstance(value, ast.Name):
            self.piece.chains.add(".".join([value.id, *reversed(names)]))
        else:
            self.visit(value)

    def visit_Call(self, node: ast.Call) -> None:
        """Patching one name of a module mentions this name alone."""
        arguments = node.args
        if _name_of(node).endswith("attr") and len(arguments) > 1 and isinstance(arguments[0], ast.Name):
            text = arguments[1].value if isinstance(arguments[1], ast.Constant) else ""
            if isinstance(text, str) and text.isidentifier():
                self.piece.chains.add(f"{arguments[0].id}.{text}")
                self.piece.attributes.add(text)
                arguments = arguments[2:]
        for inner in (node.func, *self._without_command(arguments), *node.keywords):
            self.visit(inner)

    def visit_List(self, node: ast.List | ast.Tuple) -> None:
        for inner in self._without_command(node.elts):
            self.visit(inner)

    visit_Tuple = visit_List  # noqa: N815

    def _without_command(self, words: list[ast.expr]) -> list[ast.expr]:
        """Note the module that Python is to start, and return the other words."""
        texts = [one.value if isinstance(one, ast.Constant) else None for one in words]
        if "-m" not in texts[:-1]:
            return words
        place = texts.index("-m") + 1
        self.piece.started.add(str(texts[place]))
        return [*words[:place], *words[place + 1 :]]

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        # The fields of a class: libraries read their types, and mention them by name.
        for inner in (node.target, node.annotation, node.value):
            if inner is not None:
                self.visit(inner)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, str):
            self.piece.strings.add(node.value)
            if "import " in node.value:
                self._read_program(node.value)

    def _read_program(self, text: str) -> None:
        """Note what a text imports and mentions, if it is a program, such as a cell that a test runs in a kernel."""
        with contextlib.suppress(SyntaxError):
            program = ast.parse(text)
            self.piece.strings |= {one.name for one in imports_in(program)}
            self.visit(program)
