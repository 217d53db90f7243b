"""A program's text with its syntax tree, and edits of it that leave everything else as it is written."""

from __future__ import annotations

import ast
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

NodeT = TypeVar("NodeT", bound=ast.AST)
SAYS = ("debug", "info", "warn", "warning", "error", "fatal", "print", "write")
"""Calls that log or print."""
SIGNS: dict[type[ast.AST], str] = {
    **{ast.Lt: "<", ast.Gt: ">", ast.LtE: "<=", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="},
    **{ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%", ast.And: "and", ast.Or: "or"},
}
"""How operators are written."""
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


@dataclass(frozen=True)
class Edit:
    """One piece of a text, and what stands there instead.

    Attributes:
        start: Offset of its first character.
        end: Offset behind its last character.
        text: The replacement.
        where: The definitions around the piece, such as ``"TalkerNode.__init__"``; part of a mutant's id.
        kind: Which of several things the operator did, such as ``"times 0.5"``. The same thing may be done in all
            places of a method at once; empty if that would mean nothing.
        also: Further pieces that are replaced at the same time. None of them overlaps another.
    """

    start: int
    end: int
    text: str
    where: str = ""
    kind: str = ""
    also: tuple[Edit, ...] = ()

    @property
    def pieces(self) -> list[Edit]:
        """All pieces that are replaced, in the order of the text."""
        return sorted((self, *self.also), key=lambda piece: piece.start)

    def applied(self, text: str) -> str:
        """Return the text with all pieces replaced."""
        for piece in reversed(self.pieces):
            text = text[: piece.start] + piece.text + text[piece.end :]
        return text


class Code:
    """A Python program.

    Attributes:
        text: As it is written.
        tree: Its syntax tree.
    """

    def __init__(self, text: str, *, subject: str = "", logs: bool = True) -> None:
        """Read a program.

        Args:
            text: As it is written.
            subject: A class or function of the program: only what it needs is looked at. All of it where empty.
            logs: Whether what it logs and prints may be changed.

        Raises:
            SyntaxError: The text is not valid Python.
        """
        self.text = text
        self.tree = ast.parse(text)
        self._subject = subject
        self._logs = logs
        lines = text.splitlines(keepends=True)
        self._lines = [0]
        for line in lines:
            self._lines.append(self._lines[-1] + len(line))
        self._bytes = [line.encode() for line in lines]

    @cached_property
    def parents(self) -> dict[ast.AST, ast.AST]:
        """The node around each node."""
        return {child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)}

    @cached_property
    def nodes(self) -> tuple[ast.AST, ...]:
        """The nodes that may be changed, in the order of the text: no imports, docstrings, types or main guards."""
        found: list[ast.AST] = []
        for statement in self.wanted():
            found += [node for node in _changeable(statement, self._logs) if self._is_placed(node)]
        return tuple(
            sorted(found, key=lambda node: (getattr(node, "lineno", 0), getattr(node, "col_offset", 0)))
        )

    def all(self, *kinds: type[ast.AST]) -> Iterator[Any]:
        """The nodes of some kinds that may be changed."""
        for node in self.nodes:
            if isinstance(node, kinds):
                yield node

    def bodies(self) -> Iterator[list[ast.stmt]]:
        """Each list of statements that follow each other, without docstrings and imports."""
        allowed = set(self.nodes)
        for node in (self.tree, *self.nodes):
            for name in ("body", "orelse", "finalbody"):
                body = getattr(node, name, None)
                if isinstance(body, list):
                    yield [statement for statement in body if statement in allowed]

    def span(self, node: ast.AST) -> tuple[int, int]:
        """Return the offsets at which a node begins and ends."""
        assert isinstance(node, (ast.expr, ast.stmt, ast.keyword, ast.arg))
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self._offset(node.lineno, node.col_offset), self._offset(node.end_lineno, node.end_col_offset)

    def source(self, node: ast.AST) -> str:
        """A node as it is written."""
        start, end = self.span(node)
        return self.text[start:end]

    def replaced(self, node: ast.AST, text: str, kind: str = "") -> Edit:
        """Return the edit that puts something else in the place of a node."""
        return Edit(*self.span(node), text, self.where(node), kind)

    def wrapped(self, node: ast.AST, form: str, kind: str = "") -> Edit:
        """Return the edit that puts a node into a form such as ``"abs({})"``."""
        return self.replaced(node, form.replace("{}", self.source(node)), kind)

    def head_replaced(self, node: ast.AST, old: str, new: str, kind: str = "") -> Edit:
        """Return the edit that puts something else in the place of what a node begins with."""
        start, _ = self.span(node)
        return Edit(start, start + len(old), new, self.where(node), kind)

    def tail_replaced(self, node: ast.AST, old: str, new: str, kind: str = "") -> Edit:
        """Return the edit that puts something else in the place of what a node ends with."""
        _, end = self.span(node)
        return Edit(end - len(old), end, new, self.where(node), kind)

    def sign_replaced(self, left: ast.expr, right: ast.expr, old: str, new: str, kind: str = "") -> Edit:
        """Return the edit that puts another operator between two operands."""
        start = self.text.index(old, self.span(left)[1], self.span(right)[0])
        return Edit(start, start + len(old), new, self.where(left), kind)

    def exchanged(self, one: ast.expr, other: ast.expr) -> Edit:
        """Return the edit in which two expressions change places."""
        also = (self.replaced(other, self.source(one)),)
        return replace(self.replaced(one, self.source(other)), also=also)

    def swapped(self, first: ast.AST, second: ast.AST) -> Edit:
        """Return the edit that turns the order of two neighbors round."""
        (start, middle), (begin, end) = self.span(first), self.span(second)
        between = self.text[middle:begin]
        return Edit(start, end, self.source(second) + between + self.source(first), self.where(first))

    def left_out(self, element: ast.AST) -> Edit:
        """Return the edit that leaves out an element of a list, or an argument, with the comma behind it."""
        start, end = self.span(element)
        while self.text[end : end + 1] in (",", " "):
            end += 1
        return Edit(start, end, "", self.where(element))

    def before(self, statement: ast.stmt, text: str, kind: str = "") -> Edit:
        """Return the edit that puts a statement in front of another one."""
        start, _ = self.span(statement)
        return Edit(start, start, f"{text}\n{self.indentation(statement)}", self.where(statement), kind)

    def after(self, statement: ast.stmt, text: str) -> Edit:
        """Return the edit that puts a statement behind another one."""
        _, end = self.span(statement)
        return Edit(end, end, f"\n{self.indentation(statement)}{text}", self.where(statement))

    def calls(self, *names: str) -> Iterator[Any]:
        """Yield the calls that may be changed of functions with these last names, such as ``create_timer``."""
        return (call for call in self.all(ast.Call) if called(call) in names)

    def comparisons(self) -> Iterator[tuple[ast.Compare, ast.expr, str, ast.expr]]:
        """Yield each comparison of two operands: the whole one, the first, the sign, the second."""
        for compare in self.all(ast.Compare):
            lefts = (compare.left, *compare.comparators)
            for left, sign, right in zip(lefts, compare.ops, compare.comparators, strict=False):
                yield compare, left, SIGNS.get(type(sign), ""), right

    def smallest(self, nodes: Iterable[NodeT], start: int, end: int) -> NodeT | None:
        """Return the smallest of some nodes around a piece of the text; None if none is around it."""
        spans = ((self.span(node), node) for node in nodes)
        around = [(last - first, node) for (first, last), node in spans if first <= start and end <= last]
        return min(around, key=lambda one: one[0])[1] if around else None

    def functions(self) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
        """Yield the functions and methods that may be changed."""
        yield from self.all(ast.FunctionDef, ast.AsyncFunctionDef)

    def function_of(self, node: ast.AST) -> ast.FunctionDef | ast.AsyncFunctionDef | None:
        """Return the function or method around a node; None outside of all."""
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
        around = self.ancestor(node, lambda one: isinstance(one, kinds))
        return around if isinstance(around, kinds) else None

    def mark(self, node: ast.AST) -> str:
        """Return a name for a place that edits of other functions leave as it is."""
        function = self.function_of(node)
        first = getattr(function, "lineno", 0)
        return f"{getattr(node, 'lineno', 0) - first}_{getattr(node, 'col_offset', 0)}"

    def own_values(self, node: ast.AST) -> str:
        """Return the dictionary in which a change keeps values: that of the object, or of the module outside of one."""
        function = self.function_of(node)
        first = function.args.args[:1] if function is not None else []
        return "self.__dict__" if [one.arg for one in first] == ["self"] else "globals()"

    def method(self, callback: ast.expr) -> ast.FunctionDef | ast.AsyncFunctionDef | None:
        """Return the method that an expression such as ``self.on_scan`` names; None if it names none."""
        name = self.source(callback).rpartition(".")[2]
        return next((function for function in self.functions() if function.name == name), None)

    def indentation(self, statement: ast.stmt) -> str:
        """The white space in front of a statement's first line."""
        start = self._lines[statement.lineno - 1]
        return self.text[start : self._offset(statement.lineno, statement.col_offset)]

    def stands_alone(self, statement: ast.stmt) -> bool:
        """Whether nothing but white space is in front of it on its line."""
        return not self.indentation(statement).strip()

    def line(self, offset: int) -> int:
        """The number of the line of a place in the text, from 1."""
        return self.text.count("\n", 0, offset) + 1

    def where(self, node: ast.AST) -> str:
        """The names of the definitions around a node."""
        names = []
        around: ast.AST | None = node
        while around is not None:
            if isinstance(around, _DEFINITIONS):
                names.append(around.name)
            around = self.parents.get(around)
        return ".".join(reversed(names))

    def ancestor(self, node: ast.AST, fits: Callable[[ast.AST], bool]) -> ast.AST | None:
        """The nearest node around this one that fits."""
        around = self.parents.get(node)
        while around is not None and not fits(around):
            around = self.parents.get(around)
        return around

    def _is_placed(self, node: ast.AST) -> bool:
        """Whether the text at a node's place is the node: in some f-strings Python 3.11 is wrong about it."""
        if not isinstance(node, ast.expr):
            return True
        if isinstance(node, ast.FormattedValue):
            return False
        if isinstance(getattr(node, "ctx", None), ast.Store):
            return True
        try:
            there = ast.parse(f"({self.source(node)}\n)", mode="eval").body
        except (SyntaxError, IndexError):
            return isinstance(node, ast.Starred)
        return ast.dump(there) == ast.dump(node)

    def _offset(self, line: int, column: int) -> int:
        return self._lines[line - 1] + len(self._bytes[line - 1][:column].decode())

    def wanted(self) -> list[ast.stmt]:
        """The statements of the module that may be changed: all, or those that the subject needs."""
        if not self._subject:
            return self.tree.body
        made = {name: statement for statement in self.tree.body for name in _made(statement)}
        wanted: list[ast.stmt] = []
        ahead = [self._subject]
        while ahead:
            statement = made.pop(ahead.pop(), None)
            if statement is not None and statement not in wanted:
                wanted.append(statement)
                ahead += [node.id for node in ast.walk(statement) if isinstance(node, ast.Name)]
        return sorted(wanted, key=lambda statement: statement.lineno)


def _made(statement: ast.stmt) -> list[str]:
    """The names that a statement of a module defines, imports left out."""
    if isinstance(statement, _DEFINITIONS):
        return [statement.name]
    targets: list[ast.expr] = [statement.target] if isinstance(statement, ast.AnnAssign) else []
    targets += statement.targets if isinstance(statement, ast.Assign) else []
    return [target.id for target in targets if isinstance(target, ast.Name)]


def _changeable(node: ast.AST, logs: bool) -> Iterator[ast.AST]:
    if isinstance(node, (ast.Import, ast.ImportFrom)) or _is_docstring(node):
        return
    if not logs and isinstance(node, ast.Expr) and called(node.value) in SAYS:
        return
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "bases") or (
            name == "test" and _is_main_guard(node)
        ):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _changeable(child, logs)


def _is_docstring(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and text_of(node.value) is not None


def text_of(node: ast.AST | None) -> str | None:
    """Return the text that stands in a program as it is, not as an f-string; None for any other node."""
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None


def _is_main_guard(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "__name__" in {
        inner.id for inner in ast.walk(node.test) if isinstance(inner, ast.Name)
    }


def called(node: ast.AST | None) -> str:
    """Return the last name of a called function: ``"create_timer"`` for ``self.create_timer(…)``; empty for no call."""
    if not isinstance(node, ast.Call):
        return ""
    function = node.func
    return str(getattr(function, "attr", getattr(function, "id", "")))


def argument(call: ast.Call, place: int, keyword: str) -> ast.expr | None:
    """An argument of a call, given by its place or by its name."""
    for given in call.keywords:
        if given.arg == keyword:
            return given.value
    plain = call.args[: place + 1]
    if len(plain) <= place or any(isinstance(value, ast.Starred) for value in plain):
        return None
    return plain[place]


def given(call: ast.Call, places: Mapping[str, tuple[int, str]]) -> ast.expr | None:
    """Return the argument of a call that has its place and name in a table, by the name of the function."""
    place = places.get(called(call))
    return argument(call, *place) if place else None


def paced(code: Code) -> bool:
    """Whether others can see at which pace a program works: it publishes, or serves an action."""
    return any(code.calls("create_publisher", "ActionServer"))
