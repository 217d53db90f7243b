"""The handling of a path that is given in place of a command."""

from __future__ import annotations

from dataclasses import dataclass

ALONE = "--alone"
"""The first argument of a start of one program in place of a launch; what follows is as ``ros2 run`` takes it."""


@dataclass(frozen=True)
class RunsProgram:
    """The workspace is built, and a program of one of its packages run.

    Attributes:
        package: The package.
        program: The program, as ``ros2 run`` knows it.
    """

    package: str
    program: str


@dataclass(frozen=True)
class RunsPrograms:
    """The workspace is built, and of one of its packages the program run whose name each start gives first.

    Attributes:
        package: The package.
        programs: The programs, as ``ros2 run`` knows them, in the order of the task.
    """

    package: str
    programs: tuple[str, ...]


@dataclass(frozen=True)
class ServesInterface:
    """The workspace is built, and a service type that it makes is served by a node of ours.

    Attributes:
        file: The file of the service type, such as ``"AddTwoInts.srv"``, in whatever package.
        service: The name under which it is served.
    """

    file: str
    service: str


@dataclass(frozen=True)
class Launches:
    """The launch file is launched, with what it needs of the workspace around it.

    A start whose arguments begin with :data:`ALONE` is one of a program, where the launch would find it.
    """


@dataclass(frozen=True)
class LaunchesFromPackage:
    """The workspace is built, and a launch file that one of its packages has installed is launched.

    A start whose arguments begin with :data:`ALONE` is one of a program, as with :class:`Launches`.

    Attributes:
        package: The package.
        file: The name of the launch file without the ending of its language, such as ``"remap.launch"``.
    """

    package: str
    file: str


Runner = RunsProgram | RunsPrograms | ServesInterface | Launches | LaunchesFromPackage
