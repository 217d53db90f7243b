"""Mistakes of a node that is on the ROS graph, hangs nowhere, and yet does nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.mistakes.common_mistakes import twin, worked
from autograder.kit.model import Mistake, mistake

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence

NO_MESSAGE = "Your node has a publisher on {}, but no message arrives there while the judge listens."
PUBLISH = (
    "If your code still has a TODO, write that step first. A callback, such as a timer's, must call publish(...) with "
    "the message between the parentheses; a log line is not a message. The period of a timer is in seconds."
)

NO_MORE = "Your node published {} and then no more, although it still exists."
GO_ON = (
    "The task has no end: a timer has to call the method that publishes again and again. If your node has no timer, "
    "make one with create_timer. If it has one, delete the code that stops it, or that returns from the callback "
    "before it publishes."
)


def never_published() -> Mistake:
    """Return the mistake "never published": the node has all its endpoints, and publishes nothing on a topic."""

    def silent(evidence: Evidence) -> str:
        part, interface = evidence.main, evidence.reference.interface
        if part.ending is not None or part.of("unanswered"):
            return ""
        topics = interface.get("publisher", {})
        # Of a node that answers goals or requests, the answers say more.
        if any(event.data.get("values") for event in part.of("noted") if event.name not in topics):
            return ""
        # Without all its endpoints, the node was given nothing.
        if any(ends.keys() - part.endpoints(role) for role, ends in interface.items()):
            return ""
        silent = (one for one in topics if not part.of("message", one) and _publishes(evidence, one))
        return next(silent, "")

    return mistake("never_published", silent, NO_MESSAGE, PUBLISH, uses=("publish",))


def _publishes(evidence: Evidence, topic: str) -> bool:
    """Return True if the reference solution publishes on the topic in the same run."""
    for part in evidence.reference.parts:
        if part.name == evidence.main.name:
            told = (event.data.get("values") for event in part.of("noted", topic))
            return bool(part.of("message", topic)) or any(told)
    return False


def _silent_twin(evidence: Evidence) -> str:
    """Return the name that two nodes share, if the subject did nothing that only a node that is spun can do."""
    part = evidence.main
    return "" if worked(part, "subscription") else twin(part)


SECOND_NODE = mistake(
    "never_spun",
    _silent_twin,
    "Two of your nodes are called {}, and only one of them is spun.",
    "If your class makes another Node(...), delete that call: self is the node, so write self.create_publisher, "
    "self.create_subscription or self.create_timer.",
)
"""The mistake of a class that makes a second node and gives its endpoints to that one."""
