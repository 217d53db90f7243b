"""Reads from the evidence how a service client behaved in its runs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import re2

from autograder.kit import giving_up
from autograder.kit.evidence import Evidence
from autograder.kit.in_words import counted
from autograder.kit.mistakes.client_waits import Wait
from autograder.kit.model import Finding
from autograder.kit.reported_texts import mentions, not_filled_in, said_first_after

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Part, Reference
    from autograder.kit.model import Advice


LATE = "the service comes late"
BIASED = "the answers are surprising"
EXTREME = "64-bit numbers"
ABSENT = "there is no service"
CALLED = (LATE, BIASED, EXTREME)
"""The names of the parts in which the service answers."""

HANGS_AFTER = 8.0
"""The number of seconds without any event after which a client counts as hung.

A client that calls before the service exists loses its call, and then looks like a client that rightly waits for the
service with a timer. No event tells these clients apart: the judge receives calls only as a server, and the client
would find that server. So the judge watches both for this time, in the fast look and again in real time.
"""


@dataclass(frozen=True)
class ClientSeen:
    """A service client as it behaved in its runs, or as it was recorded from the reference solution.

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
        """The number of calls in the run in which the service comes late."""
        return len(requests(self.late))

    @property
    def had_client(self) -> bool:
        """True if the client was seen on the ROS graph in any run."""
        return isinstance(self.evidence, Evidence) and self.evidence.ever_had("client")

    def called_each_time(self) -> bool:
        """True if the client made at least one call in each run with a service, so it was not too early for any."""
        return all(map(requests, self.served))

    def called(self, wanted: int) -> bool:
        """Return True if the client made exactly this many calls in each run with a service."""
        return all(len(requests(part)) == wanted for part in self.served)


def requests(part: Part) -> list[Event]:
    """Return the requests that the service received in a part, in order of time."""
    return part.of("request")


def answers(part: Part) -> list[int]:
    """Return the sums that the service answered in a part, in order of time."""
    return [int(event.data["fields"]["sum"]) for event in part.of("response")]


def pair(event: Event) -> list[int]:
    """Return the two numbers of a request, the smaller first."""
    # A sum does not depend on which number is a and which is b.
    return sorted((int(event.data["fields"]["a"]), int(event.data["fields"]["b"])))


def reports(part: Part) -> bool:
    """Return True if the client reports the last answer. A function must also return the answer."""
    given = part.of("response")
    said = bool(given) and mentions(part.said(after=given[-1]), answers(part)[-1])
    return said and not _says_otherwise(part)


def returns_another(part: Part) -> bool:
    """Return True if a notebook's function returned anything but the last answer, whatever it logged."""
    given = answers(part)
    return bool(given) and part.returned not in (None, str(given[-1]))


def _says_otherwise(part: Part) -> bool:
    """Return True if the client returns or prints something that contradicts the last answer.

    The result is True even if the client reports the answer rightly elsewhere. An exception in a notebook's function
    also counts as a contradiction, because the function returned no answer; so does a line with the answer and the
    wrong sign.
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
    """Return True if the client reported its answer number ``calls`` (from 1), or any later answer.

    Any of these answers counts, because the judge stops a client that goes on calling at some moment, and the verdict
    must not depend on that moment.
    """
    return any(
        mentions(part.said(after=given), int(given.data["fields"]["sum"]))
        for given in part.of("response")[calls - 1 :]
    )


def new_words(part: Part, given: Event | None = None) -> list[str]:
    """Return the client's lines after an answer (by default the last one), without late copies of earlier lines."""
    given = given or next(reversed(part.of("response")), None)
    return list(filter(str.strip, said_first_after(given, part)))


def braces_left(part: Part) -> Advice | None:
    """Return advice if the client printed a variable's name in braces, because the f before its string is missing."""
    return not_filled_in(new_words(part))


def reports_the_sum(evidence: Evidence) -> Finding:
    """Decide whether the client logs, prints or returns the last answer."""
    calls = max(1, ClientSeen(evidence.reference).calls)
    silent = next(
        (
            p
            for p in ClientSeen(evidence).served
            if _says_otherwise(p) or not (reports(p) or has_reported(p, calls))
        ),
        None,
    )
    if silent is None:
        return Finding(True, "the final sum, in each run", "the final sum, in each run")
    given = answers(silent)
    if returns_another(silent):
        return Finding(False, f"{given[-1]} said and returned", f"it returned {silent.returned}")
    # The answer to an earlier call is not the final sum.
    wanted = f"{given[-1]} said at the end" if len(given) >= calls else "the final sum, in each run"
    lines = silent.said(after=silent.of("response")[-1]) if given else silent.said()
    # The last line of a Python message may consist of marks such as ^^^ only, so such lines are skipped.
    lines = [line for line in lines if re2.search(r"[\pL\pN]", line)]
    wrong = [line for line in lines if given and not mentions([line], given[-1])] or lines
    return Finding(False, wanted, f"“{wrong[-1]}”" if wrong else "nothing was said")


WAIT = Wait("service", "client", "request", ABSENT, CALLED)
"""The criterion and the mistakes of a client that waits for a service."""


def gives_up_in_time(evidence: Evidence) -> Finding:
    """Decide whether the client handles a missing service well.

    The client may report the missing service and end, or it may repeatedly report that it waits.
    """
    alone = _own_sum(evidence.part(ABSENT)) is not None
    return WAIT.gives_up(evidence, "reported a sum although no service answered" if alone else "")


def _own_sum(part: Part) -> int | None:
    """Return the sum that the client reported although no service existed, so that it added the numbers itself.

    Return None if there is no such sum. A sum that equals one of the inputs does not count, because it proves nothing.
    """
    numbers = part.inputs.get("numbers", ())
    total = sum(numbers)
    return total if numbers and total not in numbers and mentions(part.said(), total) else None


no_limit = giving_up.remark(ABSENT)
SUM_COUNTS = "A function has to return it, and a program to log or print it."
"""Says on the card which ways to report the sum count."""


def how_it_went(part: Part) -> str:
    """Return in words how the client ended in a part, such as "it exited after 2 calls"."""
    if not part.events:
        return "not reached"
    ending = part.ending
    if ending is None:
        return "it made no call and did not end"
    return f"it {ending.name} after {counted(len(requests(part)), 'call')}"


def cut_short(client: ClientSeen) -> str:
    """Return in words why the judge left out later runs: the client hung. Empty if all runs were made."""
    hung = next((part for part in client.served if part.events and part.ending is None), None)
    if hung is None or all(part.events for part in client.served):
        return ""
    count = len(requests(hung))
    made = "no call" if not count else "one call" if count == 1 else f"{count} calls"
    return f"{made} ({hung.name}), then it hung, so the other runs were left out"


def ended_before_its_answer(part: Part) -> bool:
    """Return True if the subject ended while one of its calls was unanswered."""
    if part.ending is None:
        return False
    asked = max(len(requests(part)), len(part.of("called")))
    given = sum(event.t <= part.ending.t for event in part.of("response"))
    return asked > given
