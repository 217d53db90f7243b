"""Names: of topics, services, actions and fields."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import SAYS, Code, Edit, called, given, text_of

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
    for call in code.calls(*ENDPOINTS):
        name = given(call, ENDPOINTS)
        text = text_of(name)
        if name is not None and text is not None:
            yield code.replaced(name, repr(text[:-1]))
            yield code.replaced(name, repr(f"~/{text.lstrip('/')}"))
        elif name is not None:
            yield code.wrapped(name, "({})[:-1]")


def field_name(code: Code) -> Iterator[Edit]:
    """A field that the message does not have, or another one."""
    for attribute in code.all(ast.Attribute):
        if attribute.attr in FIELDS:
            yield code.tail_replaced(attribute, attribute.attr, FIELDS[attribute.attr])
    for call in code.calls(*_MESSAGES):
        for keyword in call.keywords:
            if keyword.arg in FIELDS:
                yield code.head_replaced(keyword, keyword.arg, FIELDS[keyword.arg])


def exchanged(code: Code) -> Iterator[Edit]:
    """The first two arguments of a call change places.

    Left out is the order of words in what is said, and that of two numbers, which are only ever added.
    """
    for call in code.all(ast.Call):
        if len(call.args) >= 2 and not any(isinstance(value, ast.Starred) for value in call.args[:2]):
            first, second = call.args[:2]
            if called(call) in (*SAYS, "format") or called(first) == called(second) == "int":
                continue
            yield code.swapped(first, second)


OPERATORS = (endpoint_name, field_name, exchanged)
