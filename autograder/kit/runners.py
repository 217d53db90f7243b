"""The kinds of runners, which build and start a path that is given as the subject.

They print their reports, which :mod:`autograder.kit.output` reads.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

BUILDING = 180.0
"""The time limit of a build, in seconds of wall time. A Python package needs one second, an interface package ten."""
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
_KINDS: dict[str, type[Runner]] = {
    kind.__name__: kind
    for kind in (RunsProgram, RunsPrograms, ServesInterface, Launches, LaunchesFromPackage)
}


def runner_as_word(runner: Runner) -> str:
    """Return a runner as an argument for a process that cannot see the exercise, such as one in a box."""
    return json.dumps([type(runner).__name__, asdict(runner)])


def runner_from_word(word: str) -> Runner:
    """Undo :func:`runner_as_word`."""
    kind, fields = json.loads(word)
    return _KINDS[kind](**fields)
