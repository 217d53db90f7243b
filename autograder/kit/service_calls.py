"""A service client as it was seen in its runs, and questions about it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import re2

from autograder.kit import giving_up
from autograder.kit.evidence import Evidence
from autograder.kit.in_words import counted
from autograder.kit.model import Finding
from autograder.kit.texts_said import mentions, not_filled_in, said_first_after

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Part, Reference
    from autograder.kit.model import Advice

LATE = "the service comes late"
BIASED = "the answers are surprising"
EXTREME = "64-bit numbers"
ABSENT = "there is no service"
CALLED = (LATE, BIASED, EXTREME)
"""The parts in which the service answers."""

HANGS_AFTER = 8.0
"""Seconds without any event after which a client is taken to hang.

A program that calls before the service is there waits so long in both looks: 21 seconds in all on a quiet machine. No
event decides that sooner. A request without a service reaches no reader, and ROS lets the judge read requests only as
a server, which the client would see: the topic `rq/add_two_intsRequest` belongs to services, and a subscription, even
one with `avoid_ros_namespace_conventions`, reads `/rq/add_two_intsRequest`. The stack of a client whose call was lost
is also that of one whose timer waits for the service, and which is right. So a second run has to confirm the silence.
"""


@dataclass(frozen=True)
class Client:
    """A service client, as it was seen, or as it was recorded from the reference solution.

    Attributes:
        evidence: All runs of the client.
    """

    evidence: Evidence | Reference

    @cached_property
    def served(self) -> list[Part]:
        """The runs in which the service answers."""
        return [self.evidence.part(name) for name in CALLED]

    @property
    def late(self) -> Part:
        """The run in which the service comes late."""
        return self.evidence.part(LATE)

    @property
    def calls(self) -> int:
        """The number of calls if the service comes late."""
        return len(requests(self.late))

    @property
    def had_client(self) -> bool:
        """True if a client was seen in any run."""
        return isinstance(self.evidence, Evidence) and self.evidence.ever_had("client")

    def called_each_time(self) -> bool:
        """True if each run with a service has a call: then timing did not decide the number of calls."""
        return all(map(requests, self.served))

    def ended_each_time(self) -> bool:
        """True if each run ended by itself: then timing did not decide anything."""
        return all(part.ending for part in self.evidence.parts)

    def called(self, wanted: int) -> bool:
        """True if it made this many calls in each run with a service."""
        return all(len(requests(part)) == wanted for part in self.served)


def requests(part: Part) -> list[Event]:
    """Return the calls, in order."""
    return part.of("request")


def answers(part: Part) -> list[int]:
    """Return the answers, in order."""
    return [int(event.data["fields"]["sum"]) for event in part.of("response")]


def pair(event: Event) -> list[int]:
    """Return the two numbers of a call, the smaller first."""
    # For the sum it does not matter which number is a and which is b.
    return sorted((int(event.data["fields"]["a"]), int(event.data["fields"]["b"])))


def reports(part: Part) -> bool:
    """True if the last answer is said after it was given, and if a function with a return value returns that."""
    given = part.of("response")
    said = bool(given) and mentions(part.said(after=given[-1]), answers(part)[-1])
    return said and not says_otherwise(part)


def returns_another(part: Part) -> bool:
    """True if a notebook's function returned anything but the last answer, whatever it logged."""
    given = answers(part)
    return bool(given) and part.returned not in (None, str(given[-1]))


def says_otherwise(part: Part) -> bool:
    """True if one of its reports of the last answer is wrong, even if another one is right.

    A function that raised an exception returned nothing to its caller. A line with the answer and the wrong sign
    tells its reader a wrong sum.
    """
    if returns_another(part) or (part.ending is not None and part.ending.name == "raised"):
        return True
    return any(
        mentions([line], -answer) and not mentions([line], answer)
        for answer in answers(part)[-1:]
        if answer
        for line in new_words(part)
    )


def has_reported(part: Part, calls: int) -> bool:
    """True if an answer is said after it was given: the one to the call of that number (from 1), or a later one.

    A client that goes on calling is stopped at some moment, and the result must not depend on which.
    """
    return any(
        mentions(part.said(after=given), int(given.data["fields"]["sum"]))
        for given in part.of("response")[calls - 1 :]
    )


def new_words(part: Part, given: Event | None = None) -> list[str]:
    """Return the words after an answer, or after the last one, without late echoes."""
    given = given or next(reversed(part.of("response")), None)
    return list(filter(str.strip, said_first_after(given, part)))


def braces_left(part: Part) -> Advice | None:
    """The client said a variable's name in braces instead of the sum: Python fills them only in an f-string."""
    return not_filled_in(new_words(part))


def reports_the_sum(evidence: Evidence) -> Finding:
    """The last answer is logged, printed or returned."""
    calls = max(1, Client(evidence.reference).calls)
    silent = next(
        (
            p
            for p in Client(evidence).served
            if says_otherwise(p) or not (reports(p) or has_reported(p, calls))
        ),
        None,
    )
    if silent is None:
        return Finding(True, "the final sum, in each run", "the final sum, in each run")
    given = answers(silent)
    if returns_another(silent):
        return Finding(False, f"{given[-1]} said and returned", f"it returned {silent.returned}")
    # The answer to an earlier call is not the sum.
    wanted = f"{given[-1]} said at the end" if len(given) >= calls else "the final sum, in each run"
    lines = silent.said(after=silent.of("response")[-1]) if given else silent.said()
    # A message of Python's may end with a line that only marks a character of the one above.
    lines = [line for line in lines if re2.search(r"[\pL\pN]", line)]
    wrong = [line for line in lines if given and not mentions([line], given[-1])] or lines
    return Finding(False, wanted, f"“{wrong[-1]}”" if wrong else "nothing was said")


def gives_up_in_time(evidence: Evidence) -> Finding:
    """Without a service the client gives up, or goes on, as the one rule for all clients requires."""
    part = evidence.part(ABSENT)
    if own_sum(part) is not None:
        wrong = "named a sum that no service gave"
    else:
        wrong = giving_up.objection(part, served_otherwise(evidence), "client")
    seen = "says again and again that it waits" if giving_up.goes_on_waiting(part) else "it did"
    return Finding(not wrong, f"says {giving_up.NOT_AVAILABLE} and ends by itself", wrong or seen)


def own_sum(part: Part) -> int | None:
    """Return the sum of the inputs if a client said it in the run without a service: it added up by itself.

    A sum that is one of the inputs shows nothing.
    """
    numbers = part.inputs.get("numbers", ())
    total = sum(numbers)
    return total if numbers and total not in numbers and mentions(part.said(), total) else None


def served_otherwise(evidence: Evidence) -> list[Part]:
    """Return the runs in which the client had its service."""
    absent = evidence.part(ABSENT)
    elsewhere = giving_up.looks_elsewhere(evidence, absent, "client")
    return giving_up.served_otherwise(
        Client(evidence).served, absent, lambda part: bool(requests(part)), elsewhere
    )


no_limit = giving_up.remark(ABSENT)


def how_it_went(part: Part) -> str:
    """Return the end of a part, in words."""
    if not part.events:
        return "not reached"
    ending = part.ending
    if ending is None:
        return "it made no call, and did not end"
    return f"it {ending.name} after {counted(len(requests(part)), 'call')}"


def cut_short(client: Client) -> str:
    """Return the event that ended the judge's runs early, because the client hung; empty if all runs were made."""
    hung = next((part for part in client.served if part.events and part.ending is None), None)
    if hung is None or all(part.events for part in client.served):
        return ""
    count = len(requests(hung))
    made = "no call" if not count else "one call" if count == 1 else f"{count} calls"
    return f"{made} ({hung.name}), then it hung; the other runs were left out"


def ended_before_its_answer(part: Part) -> bool:
    """True if the subject ended before an answer was sent, or before a call of it was sent."""
    if part.ending is None:
        return False
    asked = max(len(requests(part)), len(part.of("called")))
    given = sum(event.t <= part.ending.t for event in part.of("response"))
    return asked > given
