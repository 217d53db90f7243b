"""The messages to and from the judge: a notebook requests checks, and the grader gives orders.

The judge does not trust the notebook. Each check has its own connection to the judge's Unix socket. The notebook's
messages only report the subject's output and how each run ends. The judge itself observes the traffic on the wire. The
grader's orders and the judge's reports use another socket, which no notebook has.
"""

from __future__ import annotations

from typing import Any

import msgspec

from autograder.messages.json_lines import Message
from autograder.messages.run_messages import (
    Exited,
    Interrupt,
    Output,
    Ready,
    RunMessage,
    Start,
    Stop,
    Stopped,
)
from autograder.messages.workspace_messages import Source
from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)

SOCKET_VARIABLE = "AUTOGRADER_JUDGE_SOCKET"
"""The environment variable for the path of the judge's socket. A kernel without this variable starts its own judge."""

# --- From the notebook: about its check


class Check(Message, frozen=True):
    """The notebook's first message, which requests a check.

    Attributes:
        kind: ``"class"`` for a Node class, ``"path"`` for a workspace or a launch file, ``"function"`` for everything
            else.
    """

    exercise: str
    kind: str = "function"


class EndpointsMet(Message, frozen=True, tag="met"):
    """The answer to :class:`Meet`: True if the participant sees the new endpoints, and none of the removed ones."""

    seen: bool


class OwnLine(msgspec.Struct, frozen=True):
    """A line of the student's code that uses a name, such as ``publish``.

    Attributes:
        name: The name.
        place: The cell or file with this line, such as ``your cell``.
        number: The number of the line, counted from 1.
        text: The text of the line, cut.
    """

    name: str
    place: str
    number: int
    text: str


class OwnLines(Message, frozen=True, tag="own_lines"):
    """The lines of the student's code, for a card to quote. This is a claim: no point depends on it."""

    lines: list[OwnLine]


class Sources(Message, frozen=True):
    """The last message of the reply to :class:`Collect`. Before it, the notebook sends a :class:`Source` for each file.

    Attributes:
        path: The relative path of the workspace or launch file to check.
        trouble: Why no sources could be sent, in words for the student; empty if they were sent.
    """

    path: str
    trouble: str = ""


# --- From the notebook: about a run of its subject


class Started(RunMessage, frozen=True):
    """The class or function was called. ``accepted`` lists the options of :class:`Start` that a function takes."""

    accepted: list[str]


class Constructed(RunMessage, frozen=True):
    """The node's constructor has returned. ``marker`` is a topic that was created after all of the node's endpoints.

    ``goes_on`` is true if the node has a timer or a thread, which may make more endpoints once the node spins.
    ``twin`` is the node's name if the constructor has made a second node with this name.
    """

    marker: str
    goes_on: bool = False
    twin: str = ""


class Called(RunMessage, frozen=True):
    """The subject has called a service, or has sent a goal."""


class Looked(RunMessage, frozen=True):
    """The subject has read the ROS graph."""


class Returned(RunMessage, frozen=True):
    """The function has returned; ``value`` is the ``repr`` of its result, or None if the result is None."""

    value: str | None = None


class Raised(RunMessage, frozen=True):
    """The subject has raised an exception, and has ended."""

    traceback: str


class Stacks(RunMessage, frozen=True, tag="stack"):
    """The stacks of the subject's threads.

    ``busy`` is the processor time in seconds that the busiest of the threads in the student's code has used.
    """

    text: str
    busy: float = 0.0


OfRun = (
    Started | Constructed | Called | Looked | Output | Returned | Raised | Exited
    | Stacks | Stopped
)  # fmt: skip
FromNotebook = Check | Ready | EndpointsMet | OwnLines | Source | Sources | OfRun


# --- From the judge


class Begin(Message, frozen=True):
    """The judge's request to use this ROS domain.

    Attributes:
        domain: The ROS domain of this check.
        keeper: The name for the node that keeps the notebook's participant alive between the runs of a class or
            function.
    """

    domain: int
    keeper: str


class Collect(Message, frozen=True):
    """A request to send the source files of the workspace or launch file, which the grader builds and runs itself."""


class Meet(Message, frozen=True):
    """A request to wait until the participant sees the judge's new endpoints and no longer sees the removed ones.

    Attributes:
        fresh: True to make a new context first.
        there: The endpoints that the participant must see.
        gone: The endpoints of earlier runs that the participant must no longer see.
        within: The limit in seconds.
    """

    fresh: bool
    there: list[Any]
    gone: list[Any]
    within: float


class Release(RunMessage, frozen=True):
    """A request to spin the node."""


class Stack(RunMessage, frozen=True):
    """A request for the stacks of the subject's threads."""


class SoFar(Message, frozen=True, tag="so_far"):
    """The judge's findings so far, while the check goes on. No submission in a sandbox gets this message.

    Attributes:
        verdict: A verdict in the state ``checking``. What it shows as met stays met.
        words: A sentence about the first look, which the second one may show to be wrong; empty if nothing is known.
    """

    verdict: Verdict
    words: str


class Judged(Message, frozen=True, tag="verdict"):
    """The last message: the check is over.

    Attributes:
        verdict: The verdict; None if a submission in a sandbox asked for the check. The grader may run a notebook
            twice, and a submission that knew a bad verdict could spoil the first run, so that only the second counts.
    """

    verdict: Verdict | None


class Refused(Message, frozen=True):
    """The last message if the judge refuses the check. It contains the reason."""

    why: str


FromJudge = Begin | Collect | Meet | Start | Release | Interrupt | Stack | Stop | SoFar | Judged | Refused


# --- From and to the grader


class Open(msgspec.Struct, tag="open", frozen=True):
    """An order to allow the notebook one check of this exercise.

    Attributes:
        exercise: The exercise's id.
        seed: The seed of the random inputs.
        record: True to record a reference output instead of judging.
        drawing: The drawing of a class that the subject is given: a recording of the solution in it, as JSON. With
            ``record``, the name of the drawing to record. Empty for the practice drawings of the reference output.
        workspaces: The path at which the judge reaches the socket of the grader's workspace service; empty if the
            grader runs no such service.
        evidence: True to add the evidence to the report.
        boxed: True if judge and notebook are in sandboxes, as for a submission. No other program is on the network of
            the sandboxes, so a ROS domain is free even if its ports seem to be in use. The judge reports the verdict
            only to the grader; :class:`Judged` gives the reason.
    """

    exercise: str
    seed: str
    record: bool = False
    workspaces: str = ""
    evidence: bool = False
    boxed: bool = False
    drawing: str = ""


class Close(msgspec.Struct, tag="close", frozen=True):
    """An order to end the opened check and to report its result."""


class Report(msgspec.Struct, frozen=True):
    """The result of a check.

    Attributes:
        verdict: The judge's verdict; None if no check was requested or the judge failed.
        reference: The reference output as text, after a recording.
        trouble: Why the judge gave no verdict, in words for people; empty if it gave one or if no check was requested.
        evidence: The evidence, as :mod:`autograder.judge.evidence_files` packs it; empty if it was not requested.
        crowded: True if the subject did not pass, perhaps because the machine was overloaded.
        unfinished: True if the judge gave no verdict because the time was over.
    """

    verdict: Verdict | None = None
    reference: str | None = None
    trouble: str = ""
    evidence: bytes = b""
    crowded: bool = False
    unfinished: bool = False


Order = Open | Close
