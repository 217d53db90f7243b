"""The kinds of runners: what a check does with a path that is given as its subject instead of a command."""

from __future__ import annotations

from dataclasses import dataclass

ALONE = "--alone"
"""If this is the first argument, a runner starts one program instead of the launch file. The other arguments are then
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
        service: The name that the judge's node gives to the service.
    """

    file: str
    service: str


@dataclass(frozen=True)
class Launches:
    """Launch the given launch file. If the file is in a workspace, first build the packages that it needs.

    If the first argument is :data:`ALONE`, the runner starts one program instead, in the environment that the launch
    would have.
    """


@dataclass(frozen=True)
class LaunchesFromPackage:
    """Build the workspace, and launch a launch file that one of its packages has installed.

    If the first argument is :data:`ALONE`, the runner starts one program instead, as with :class:`Launches`.

    Attributes:
        package: The name of the package.
        file: The name of the launch file without ``.py``, ``.xml`` or ``.yaml``, such as ``"remap.launch"``.
    """

    package: str
    file: str


Runner = RunsProgram | RunsPrograms | ServesInterface | Launches | LaunchesFromPackage
