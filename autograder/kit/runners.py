"""What to do with a path that is given instead of a command."""

from __future__ import annotations

from dataclasses import dataclass

ALONE = "--alone"
"""The first argument for starting one program instead of a launch; the rest is as for ``ros2 run``."""


@dataclass(frozen=True)
class RunsProgram:
    """Build the workspace, and run a program of one of its packages.

    Attributes:
        package: The package.
        program: The program's name for ``ros2 run``.
    """

    package: str
    program: str


@dataclass(frozen=True)
class RunsPrograms:
    """Build the workspace, and run the program of one of its packages that each start names first.

    Attributes:
        package: The package.
        programs: The programs' names for ``ros2 run``, in the order of the task.
    """

    package: str
    programs: tuple[str, ...]


@dataclass(frozen=True)
class ServesInterface:
    """Build the workspace, and serve a service type that it generates with a node of the judge.

    Attributes:
        file: The file of the service type, such as ``"AddTwoInts.srv"``, in any package.
        service: The name under which it is served.
    """

    file: str
    service: str


@dataclass(frozen=True)
class Launches:
    """Launch the launch file, with what it needs from the workspace around it.

    A start whose arguments begin with :data:`ALONE` runs one program, as the launch would find it.
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
