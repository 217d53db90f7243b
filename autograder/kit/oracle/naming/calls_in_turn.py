"""Recognizes a node that makes one call after the other, although the task asks for each at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

    from autograder.kit.evidence import Part

OFTEN = 2
"""The number of calls that have to come right after an answer: one alone may be slow by chance."""
IN_TURN = (
    "While a call of {} is open, your node makes no other one: what comes meanwhile waits until the call before is "
    "answered.",
    "Make each call as soon as its input comes. A lock, a queue, one thread for all work, or `call` in a loop makes "
    "one call wait for the other: leave it out, and keep what belongs to one call in variables of its own.",
)
"""The words for such a node, and the next step."""


def called_in_turn(services: Collection[str], inputs: Collection[str], seen: Part, _: Part) -> str:
    """Return the service whose calls a node makes one after the other; empty if there is none.

    Args:
        services: The services that the judge serves.
        inputs: The topics of which each input leads to a call.
        seen: The run of the node.
    """
    for service in services:
        waiting = opened = in_turn = 0
        after_answer = False
        for event in seen.events:
            if event.kind == "sent" and event.name in inputs:
                waiting, after_answer = waiting + 1, False
            elif event.kind == "request" and event.name == service:
                if opened:
                    break
                in_turn += after_answer
                waiting, opened, after_answer = waiting - 1, 1, False
            elif event.kind == "response" and event.name == service:
                opened, after_answer = 0, waiting > 0
        else:
            if in_turn >= OFTEN:
                return service
    return ""
