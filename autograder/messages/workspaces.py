"""Messages of the grader's workspace service: to the judge for a check, to a notebook for a build.

Reports of the service and output of programs are different messages, so that no program can fake a report.
"""

from __future__ import annotations

from autograder.messages.lines import Message


class Source(Message, frozen=True):
    """One file or folder.

    Attributes:
        path: Relative, with slashes.
        data: The content of the file; None for a folder.
        executable: True if the owner may execute it.
    """

    path: str
    data: bytes | None = None
    executable: bool = False


# --- A check: from the judge


class Check(Message, frozen=True):
    """The first message, before the sources.

    Attributes:
        exercise: The exercise's id.
        domain: The ROS domain of the programs.
        path: The workspace or launch file among the sources.
        count: The number of sources that follow.
        trouble: Why there are none, for the student; empty if some follow.
    """

    exercise: str
    domain: int
    path: str
    count: int
    trouble: str = ""


class Start(Message, frozen=True):
    """Build the submission, unless it is already built, and run it.

    Attributes:
        run: The number of the run.
        arguments: The program's arguments; if an exercise is about several programs, the first one chooses the program.
    """

    run: int
    arguments: tuple[str, ...] = ()


class Interrupt(Message, frozen=True):
    """Send Ctrl-C to the program of the run, which goes on until it has ended by itself or is stopped."""

    run: int


class Stop(Message, frozen=True):
    """End the run."""

    run: int


ToService = Start | Interrupt | Stop


# --- A check: from the workspace service


class Ready(Message, frozen=True):
    """The service has received the sources."""


class BuildEnded(Message, frozen=True, tag="built"):
    """The build has ended, with or without success."""

    run: int


class ReportLine(Message, frozen=True, tag="report"):
    """A line of the service's report."""

    run: int
    text: str


class Output(Message, frozen=True):
    """A line that a program has printed."""

    run: int
    text: str


class Exited(Message, frozen=True):
    """The program has ended by itself; None if its exit code is not known."""

    run: int
    code: int | None = None


class Stopped(Message, frozen=True):
    """The run is over, and its processes have ended."""

    run: int


class Trouble(Message, frozen=True):
    """The service failed, through no fault of the submission."""

    why: str


FromService = Ready | BuildEnded | ReportLine | Output | Exited | Stopped | Trouble


# --- A build for a graded notebook


class Build(Message, frozen=True):
    """The first message, before the sources.

    Attributes:
        count: How many sources follow.
        path: The workspace among them.
        only: The packages to build.
    """

    count: int
    path: str
    only: list[str]


class NotBuilt(Message, frozen=True, tag="no"):
    """The service builds nothing for this notebook, for the given reason."""

    why: str


class BuildFailed(Message, frozen=True, tag="failed"):
    """The fields are those of :class:`autograder.workspaces.builds.colcon.Build`."""

    seconds: float
    trouble: str
    package: str
    line: str
    log: str


class BuildDone(Message, frozen=True, tag="built"):
    """The build follows as an archive.

    Attributes:
        pieces: The number of messages with the archive.
        install: The path of the install folder that its files contain.
        seconds: Wall time of the build.
    """

    pieces: int
    install: str
    seconds: float


class Piece(Message, frozen=True):
    """A part of the archive."""

    data: bytes


BuildAnswer = NotBuilt | BuildFailed | BuildDone
