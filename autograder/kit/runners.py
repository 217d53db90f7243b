"""What the workspace program should do if the subject is given as a path and not as a command."""

from __future__ import annotations

from dataclasses import dataclass

ALONE = "--alone"
"""The first argument that makes a runner start one program instead of the launch file. The remaining arguments are
those of ``ros2 run``.
"""


@dataclass(frozen=True)
class RunsProgram:
    """Build the workspace, and run a program from one of its packages.

    Attributes:
        package: The name of the package.
        program: The program's name for ``ros2 run``.
    """

    package: str
    program: str


@dataclass(frozen=True)
class RunsPrograms:
    """Build the workspace, and run programs from one of its packages. The first argument names the program to start.

    Attributes:
        package: The name of the package.
        programs: The programs' names for ``ros2 run``, in the order of the task.
    """

    package: str
    programs: tuple[str, ...]


@dataclass(frozen=True)
class ServesInterface:
    """Build the workspace, and let a node of the judge serve a service type that the workspace defines.

    Attributes:
        file: The file that defines the service type, such as ``"AddTwoInts.srv"``; it may be in any package.
        service: The name of the service under which it is served.
    """

    file: str
    service: str


@dataclass(frozen=True)
class Launches:
    """Launch the given launch file. If it lies in a workspace, build the packages that it needs first.

    If the first argument is :data:`ALONE`, the runner starts one program instead, in the environment that the launch
    would have.
    """


@dataclass(frozen=True)
class LaunchesFromPackage:
    """Build the workspace, and launch a launch file that one of its packages has installed.

    If the first argument is :data:`ALONE`, the runner starts one program instead, as with :class:`Launches`.

    Attributes:
        package: The name of the package.
        file: The name of the launch file without the ending of its language, such as ``"remap.launch"``.
    """

    package: str
    file: str


Runner = RunsProgram | RunsPrograms | ServesInterface | Launches | LaunchesFromPackage
