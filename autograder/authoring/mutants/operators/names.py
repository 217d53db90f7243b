"""Names: of topics, services, actions, nodes and fields."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import SAYS, Code, Edit, argument, called

if TYPE_CHECKING:
    from collections.abc import Iterator

ENDPOINTS = {
    "create_publisher": (1, "topic"),
    "create_subscription": (1, "topic"),
    "create_service": (1, "srv_name"),
    "create_client": (1, "srv_name"),
    "ActionServer": (2, "action_name"),
    "ActionClient": (2, "action_name"),
}
"""The place of an endpoint's name in the call that makes it."""
FIELDS = {
    "data": "date",
    "a": "b",
    "b": "a",
    "sum": "total",
    "order": "orders",
    "sequence": "partial_sequence",
    "partial_sequence": "sequence",
    "feedback": "result",
    "result": "feedback",
    "status": "state",
    "goals_canceling": "goals",
    "accepted": "status",
}
"""Fields of the course's messages, and what might be taken for each."""
_MESSAGES = ("String", "Request", "Response", "Goal", "Result", "Feedback", "Float64")


def endpoint_name(code: Code) -> Iterator[Edit]:
    """A topic, service or action whose name lacks its last letter, or is private."""
    for call in code.all(ast.Call):
        place = ENDPOINTS.get(called(call))
        name = argument(call, *place) if place else None
        if isinstance(name, ast.Constant) and isinstance(name.value, str):
            yield code.replaced(name, repr(name.value[:-1]))
            yield code.replaced(name, repr(f"~/{name.value.lstrip('/')}"))
        elif name is not None:
            yield code.wrapped(name, "({})[:-1]")


def node_name(code: Code) -> Iterator[Edit]:
    """A node of another name."""
    for call in code.all(ast.Call):
        makes = called(call) in ("create_node", "Node") or (
            called(call) == "__init__"
            and isinstance(call.func, ast.Attribute)
            and "super" in code.source(call)
        )
        name = argument(call, 0, "node_name") if makes else None
        if isinstance(name, ast.Constant) and isinstance(name.value, str):
            yield code.replaced(name, repr(f"{name.value}_2"))


def field_name(code: Code) -> Iterator[Edit]:
    """A field that the message does not have, or another one."""
    for attribute in code.all(ast.Attribute):
        if attribute.attr in FIELDS:
            _, end = code.span(attribute)
            yield Edit(end - len(attribute.attr), end, FIELDS[attribute.attr], code.where(attribute))
    for call in code.all(ast.Call):
        for keyword in call.keywords:
            if called(call) in _MESSAGES and keyword.arg in FIELDS:
                start, _ = code.span(keyword)
                yield Edit(start, start + len(keyword.arg), FIELDS[keyword.arg], code.where(call))


def exchanged(code: Code) -> Iterator[Edit]:
    """The first two arguments of a call change places.

    Left out is the order of words in what is said, and that of two numbers, which are only ever added.
    """
    for call in code.all(ast.Call):
        if len(call.args) >= 2 and not any(isinstance(value, ast.Starred) for value in call.args[:2]):
            first, second = call.args[:2]
            if called(call) in (*SAYS, "format") or called(first) == called(second) == "int":
                continue
            start, end = code.span(first)[0], code.span(second)[1]
            between = code.text[code.span(first)[1] : code.span(second)[0]]
            yield Edit(start, end, code.source(second) + between + code.source(first), code.where(call))


OPERATORS = (endpoint_name, node_name, field_name, exchanged)
