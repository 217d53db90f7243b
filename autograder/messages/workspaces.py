"""Between the grader's side of workspaces and those who ask it: the judge for a check, a notebook for a build.

Reports of the grader's side and what programs say travel as different messages, so that no program can say a report.
"""

from __future__ import annotations

from autograder.messages.lines import Message


class Source(Message, frozen=True):
    """One file or folder.

    Attributes:
        path: Relative, with slashes.
        data: The content; None for a folder.
        executable: Whether its owner may execute it.
    """

    path: str
    data: bytes | None = None
    executable: bool = False


# --- A check: what the judge says


class Check(Message, frozen=True):
    """The first message, before the sources.

    Attributes:
        exercise: The exercise's id.
        domain: The ROS domain that programs are started on.
        path: The workspace or launch file among the sources.
        count: How many sources follow.
        trouble: Why there are none, for the student; empty where there are.
    """

    exercise: str
    domain: int
    path: str
    count: int
    trouble: str = ""


class Start(Message, frozen=True):
    """Build what was submitted, where that is not done yet, and run it.

    Attributes:
        run: Its number.
        arguments: Of the program; where an exercise is about several programs, the first one says which.
    """

    run: int
    arguments: tuple[str, ...] = ()


class Interrupt(Message, frozen=True):
    """Press Ctrl-C at the program of the run, which goes on until it has ended by itself or is stopped."""

    run: int


class Stop(Message, frozen=True):
    """End the run."""

    run: int


ToService = Start | Interrupt | Stop


# --- A check: what the grader's side says


class Ready(Message, frozen=True):
    """The sources are taken."""


class BuildEnded(Message, frozen=True, tag="built"):
    """The build has ended, well or not."""

    run: int


class ReportLine(Message, frozen=True, tag="report"):
    """A line of what the grader's side has found."""

    run: int
    text: str


class Output(Message, frozen=True):
    """A line that a program has printed."""

    run: int
    text: str


class Exited(Message, frozen=True):
    """The program has ended by itself; None where nobody knows how."""

    run: int
    code: int | None = None


class Stopped(Message, frozen=True):
    """The run is over, and its processes are gone."""

    run: int


class Trouble(Message, frozen=True):
    """Something failed that says nothing of what was submitted."""

    why: str


FromService = Ready | BuildEnded | ReportLine | Output | Exited | Stopped | Trouble


# --- A build for a graded notebook


class Build(Message, frozen=True):
    """The first message, before the sources.

    Attributes:
        count: How many sources follow.
        path: The workspace among them.
        only: The packages that are wanted.
    """

    count: int
    path: str
    only: list[str]


class NotBuilt(Message, frozen=True, tag="no"):
    """Nothing is built for this notebook, and why."""

    why: str


class BuildFailed(Message, frozen=True, tag="failed"):
    """The fields are those of :class:`autograder.workspaces.colcon.Build`."""

    seconds: float
    trouble: str
    package: str
    line: str
    log: str


class BuildDone(Message, frozen=True, tag="built"):
    """The build follows as an archive.

    Attributes:
        pieces: How many messages the archive has.
        install: The path of the install folder that is in its files.
        seconds: Wall time that it took.
    """

    pieces: int
    install: str
    seconds: float


class Piece(Message, frozen=True):
    """A part of the archive."""

    data: bytes


BuildAnswer = NotBuilt | BuildFailed | BuildDone
