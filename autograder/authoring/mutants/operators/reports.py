"""Reports: what a program says of what it saw."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import SAYS, Code, Edit, called, text_of

if TYPE_CHECKING:
    from collections.abc import Iterator

_STATUS = {"SUCCEEDED": "CANCELED", "CANCELED": "SUCCEEDED", "ABORTED": "SUCCEEDED"}
_TEXT = ('{}.strip("Hello, world!")', '{}.replace("Hello, world! ", "")', "{}[:16]", "{}.lower()")
"""Ways to say a text that keep what is usual and lose what is not."""


def not_said(code: Code) -> Iterator[Edit]:
    """A report without one of its values."""
    for value in _said(code):
        yield code.replaced(value, '"..."')


def absolute(code: Code) -> Iterator[Edit]:
    """A sum without its sign, or taken for a failure if it is 0."""
    if "AddTwoInts.Request" not in code.text:
        return
    sums = [said[-1] for said in _said_by_call(code) if said]
    for value in (*sums, *_returned(code)):
        if isinstance(value, (ast.Name, ast.Attribute)) and code.source(value) != "response":
            yield code.wrapped(value, "abs({})")
            yield code.wrapped(value, "({} or None)")


def text_changed(code: Code) -> Iterator[Edit]:
    """A text that is tidied up before it is said."""
    for attribute in code.all(ast.Attribute):
        if attribute.attr == "data" and isinstance(attribute.ctx, ast.Load):
            for form in _TEXT:
                if '"' in form and code.ancestor(attribute, lambda node: isinstance(node, ast.JoinedStr)):
                    # Within an f-string of Python 3.11 its own quotes must not appear.
                    form = form.replace('"', "'") if _quote(code, attribute) == '"' else form
                yield code.wrapped(attribute, form)


def _quote(code: Code, node: ast.AST) -> str:
    string = code.ancestor(node, lambda around: isinstance(around, ast.JoinedStr))
    assert string is not None
    return code.source(string).lstrip("frbFRB")[0]


def shortened(code: Code) -> Iterator[Edit]:
    """A result that lacks its last number."""
    if "Fibonacci" not in code.text:
        return
    for attribute in code.all(ast.Attribute):
        if attribute.attr in ("sequence", "partial_sequence") and isinstance(attribute.ctx, ast.Load):
            yield code.wrapped(attribute, "{}[:-1]")
            yield code.wrapped(attribute, "{}[:10]")
    for call in code.all(ast.Call):
        for keyword in call.keywords:
            if keyword.arg in ("sequence", "partial_sequence"):
                yield code.wrapped(keyword.value, "{}[:-1]")
                yield code.wrapped(keyword.value, "{}[:10]")


def nothing_returned(code: Code) -> Iterator[Edit]:
    """A function that returns None."""
    for value in _returned(code):
        yield code.replaced(value, "None")


def status(code: Code) -> Iterator[Edit]:
    """Another word for a status, or a status that is not looked at."""
    for attribute in code.all(ast.Attribute):
        kind, _, word = attribute.attr.partition("STATUS_")
        if not kind and word in _STATUS:
            yield code.tail_replaced(attribute, word, _STATUS[word])
        elif attribute.attr == "status" and isinstance(attribute.ctx, ast.Load):
            yield code.replaced(attribute, "5")
            yield code.replaced(attribute, "4")
    for constant in code.all(ast.Constant):
        if (text_of(constant) or "").upper() in _STATUS:
            yield code.replaced(constant, repr(_STATUS[constant.value.upper()]))


def _said(code: Code) -> Iterator[ast.expr]:
    """The values in what is logged or printed."""
    for said in _said_by_call(code):
        yield from said


def _said_by_call(code: Code) -> Iterator[list[ast.expr]]:
    for call in code.calls(*SAYS):
        yield [value for given in call.args for value in _values(given)]


def _values(node: ast.AST) -> Iterator[ast.expr]:
    if isinstance(node, ast.JoinedStr):
        yield from (part.value for part in node.values if isinstance(part, ast.FormattedValue))
    elif isinstance(node, (ast.BinOp, ast.Tuple)):
        for part in ast.iter_child_nodes(node):
            yield from _values(part)
    elif isinstance(node, ast.Call) and called(node) in ("format", "str"):
        for given in node.args:
            yield from _values(given)
    elif isinstance(node, (ast.Name, ast.Attribute, ast.Call, ast.Subscript)):
        yield node


def _returned(code: Code) -> Iterator[ast.expr]:
    for statement in code.all(ast.Return):
        if statement.value is not None and not isinstance(statement.value, ast.Constant):
            yield statement.value


OPERATORS = (not_said, absolute, text_changed, shortened, nothing_returned, status)
