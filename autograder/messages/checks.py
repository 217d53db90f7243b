"""Between a notebook and the judge, over the judge's Unix socket: one conversation is one check.

The notebook's side is untrusted. Whatever it says only affects what the subject is taken to have said or done on its
own account; what happens on the wire the judge sees for itself.
"""

from __future__ import annotations

from typing import Any

from autograder.messages.lines import Message
from autograder.messages.workspaces import Source
from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)

SOCKET_VARIABLE = "AUTOGRADER_JUDGE_SOCKET"
"""The environment variable with the path of the judge's socket; a kernel without it starts a judge of its own."""

# --- What a notebook says: of its check


class Check(Message, frozen=True):
    """The first message: judge my subject.

    Attributes:
        exercise: The exercise's id.
        kind: ``"class"`` for a Node class, ``"path"`` for a workspace or a launch file,
            ``"function"`` for everything else.
    """

    exercise: str
    kind: str = "function"


class Ready(Message, frozen=True):
    """The notebook has heard on which domain the check is."""


class Met(Message, frozen=True):
    """The notebook's answer to :class:`Meet`: true if its participant has seen what that asks for."""

    seen: bool


class Sources(Message, frozen=True):
    """The end of the sources that :class:`Collect` asks for; each of them is a :class:`Source` before it.

    Attributes:
        path: The workspace or launch file among them.
        trouble: Why there are none, for the student; empty where there are.
    """

    path: str
    trouble: str = ""


# --- What a notebook says: of a run of its subject


class _RunMessage(Message, frozen=True):
    """Something that happened in a run.

    Attributes:
        run: The number that :class:`Start` gave to it.
    """

    run: int


class Started(_RunMessage, frozen=True):
    """The function is called; ``accepted`` are the names of the options that it has a parameter for."""

    accepted: list[str]


class Constructed(_RunMessage, frozen=True):
    """The node is made; ``marker`` is the topic that was made after all that its constructor makes.

    ``goes_on`` says that something of it is left, a timer or a thread, which may make more once the node is spun.
    ``twin`` is the node's name if the constructor has made a second node of this name.
    """

    marker: str
    goes_on: bool = False
    twin: str = ""


class Spared(_RunMessage, frozen=True):
    """A wait for a server was shortened by so many seconds."""

    seconds: float


class Called(_RunMessage, frozen=True):
    """The subject has called a service, or has sent a goal."""


class Willing(_RunMessage, frozen=True):
    """The subject would wait so many seconds for the answer to its call of this number."""

    seconds: float
    call: int


class Looked(_RunMessage, frozen=True):
    """The subject has asked what there is on the graph."""


class Output(_RunMessage, frozen=True):
    """A line that the subject has printed or logged."""

    text: str
    logged: bool = False


class Returned(_RunMessage, frozen=True):
    """The function has returned; ``value`` is the ``repr`` of what it returned, None where that was None."""

    value: str | None = None


class Raised(_RunMessage, frozen=True):
    """The subject has raised an exception, and has ended."""

    traceback: str


class Exited(_RunMessage, frozen=True):
    """The process that was started for a path has ended."""

    code: int | None = None


class Stacks(_RunMessage, frozen=True, tag="stack"):
    """The stacks of the subject's threads."""

    text: str


class Stopped(_RunMessage, frozen=True):
    """The run is over, and its nodes are gone."""


RunMessage = (
    Started | Constructed | Spared | Called | Willing | Looked | Output | Returned | Raised | Exited
    | Stacks | Stopped
)  # fmt: skip
FromNotebook = Check | Ready | Met | Source | Sources | RunMessage


# --- What the judge says


class Begin(Message, frozen=True):
    """Be on this ROS domain.

    Attributes:
        domain: The ROS domain of this check alone.
        keeper: The name of the node that stays, between runs, in the context in which a class or a function lives.
    """

    domain: int
    keeper: str


class Collect(Message, frozen=True):
    """Send the sources of what the check cell was given; the grader builds and runs them by itself."""


class Meet(Message, frozen=True):
    """Wait until the participant sees these endpoints of the judge, and those no more.

    Attributes:
        fresh: With a context that is made anew.
        there: Those that there should be.
        gone: Those that there were in runs before.
        within: Seconds in which this must be so.
    """

    fresh: bool
    there: list[Any]
    gone: list[Any]
    within: float


class Start(Message, frozen=True):
    """Make the node, call the function, or start the process.

    Attributes:
        run: The number of this run.
        fresh: With a context that is made anew.
        arguments: What the class or function is called with.
        options: What it gets where it has parameters of these names.
        sleep_factor: What sleeps are multiplied with; 1.0 leaves them alone.
        spare: Seconds of waits for a server that may be left out.
    """

    run: int
    fresh: bool
    arguments: list[Any]
    options: dict[str, Any]
    sleep_factor: float
    spare: float


class Release(Message, frozen=True):
    """Let the made node spin."""

    run: int


class Interrupt(Message, frozen=True):
    """Press Ctrl-C at the process that was started for a path."""

    run: int


class Stack(Message, frozen=True):
    """Say where the subject's threads are."""

    run: int


class Stop(Message, frozen=True):
    """End the run."""

    run: int


class SoFar(Message, frozen=True, tag="so_far"):
    """The check goes on, and this is known already; a later look may show that it is not so.

    Attributes:
        words: A sentence for the student; empty where nothing is known.
    """

    words: str


class Judged(Message, frozen=True, tag="verdict"):
    """The last message: the check is over.

    Attributes:
        verdict: What came of it. None for a submission in its box: one that knew how its checks went could choose which
            of two runs of its notebook counts, by what costs the first one its result.
    """

    verdict: Verdict | None


class Refused(Message, frozen=True):
    """The last message where nothing is judged, and why."""

    why: str


FromJudge = Begin | Collect | Meet | Start | Release | Interrupt | Stack | Stop | SoFar | Judged | Refused
