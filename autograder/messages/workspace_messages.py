"""The messages between the grader's workspace service and the judge (for a check) or a notebook (for a build).

The service's reports and the programs' output have different types, so that no program can fake a report.
"""

from __future__ import annotations

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


class Source(Message, frozen=True):
    """A source file or folder of a submission.

    Attributes:
        path: The relative path, with ``/`` between its parts.
        data: The content of the file; None for a folder.
        executable: True if the owner may execute it.
    """

    path: str
    data: bytes | None = None
    executable: bool = False


# --- A check: from the judge


class CheckRequest(Message, frozen=True, tag="check"):
    """The judge's first message, before the sources.

    Attributes:
        exercise: The exercise's id.
        domain: The ROS domain of the programs.
        path: The relative path of the workspace or launch file to check.
        count: The number of sources that follow.
        trouble: Why no sources follow, in words for the student; empty if they follow.
    """

    exercise: str
    domain: int
    path: str
    count: int
    trouble: str = ""


ToService = Start | Interrupt | Stop


# --- A check: from the workspace service


class BuildEnded(RunMessage, frozen=True, tag="built"):
    """The build has ended, with or without success."""


class ReportLine(RunMessage, frozen=True, tag="report"):
    """A line of the service's report."""

    text: str


class Trouble(Message, frozen=True):
    """The service itself failed; the submission is not the cause."""

    why: str


FromService = Ready | BuildEnded | ReportLine | Output | Exited | Stopped | Trouble


# --- A build for a graded notebook


class BuildRequest(Message, frozen=True, tag="build"):
    """The notebook's first message, before the sources: a request for a build.

    Attributes:
        count: The number of sources that follow.
        path: The relative path of the workspace to build.
        only: The names of the packages to build.
    """

    count: int
    path: str
    only: list[str]


class NotBuilt(Message, frozen=True, tag="no"):
    """The service does not build this workspace. ``why`` is the reason, in words."""

    why: str


class BuildFailed(Message, frozen=True, tag="failed"):
    """The build failed. The fields are those of :class:`autograder.workspaces.builds.colcon_build.Build`."""

    seconds: float
    trouble: str
    package: str
    line: str
    log: str


class BuildDone(Message, frozen=True, tag="built"):
    """The build succeeded. Its install folder follows as an archive, in :class:`Piece` messages.

    Attributes:
        pieces: The number of messages that contain the archive.
        install: The path at which the build's files expect the install folder to be.
        seconds: The duration of the build, in seconds of wall time.
    """

    pieces: int
    install: str
    seconds: float


class Piece(Message, frozen=True):
    """A part of the archive."""

    data: bytes


BuildAnswer = NotBuilt | BuildFailed | BuildDone
