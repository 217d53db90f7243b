"""Boxes for a command that a user runs by hand."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.boxes import syscalls
from autograder.boxes.enter_box import take_limits
from autograder.boxes.environment import box_environment
from autograder.boxes.guards import BoxGuard
from autograder.boxes.limits import Limits
from autograder.boxes.mounts import SYSTEM, Bind, box_arguments, installation
from autograder.boxes.sandbox import SCRATCH_BYTES, SCRATCH_INODES
from autograder.boxes.supervisor import bubblewrap, furnish

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_OF_PYTHON = ("PYTHONUNBUFFERED", "PYTHONFAULTHANDLER")


class OneCommandBox:
    """Gives this process a new network, and each start of a command a separate box in that network.

    Args:
        scratch: An empty folder. Only this process and the boxes see the files that are made in it.
        folder: The folder of the user that a command sees, read-only and at the same path. It is also the working
            folder.
        command: The command, which is checked for names of files that would not be visible.

    Raises:
        ValueError: The folder contains files that no box may see, or the command needs files outside the folder. The
            exception's text says what to do.
    """

    def __init__(self, scratch: Path, folder: Path, command: Sequence[str]) -> None:
        self._scratch, self._folder = scratch, folder.resolve()
        for word in command:
            file = self._folder / word
            if os.sep in word and file.exists() and not self._sees(file):
                raise ValueError(
                    f"a command in a box sees only the folder in which it starts, and {word} is not in "
                    f"{self._folder}: change to the folder of the submission, and use a path relative to it"
                )
        for kept in (Path.home(), Path(__file__).resolve().parents[2]):
            if kept.resolve().is_relative_to(self._folder):
                raise ValueError(
                    f"a command in a box sees the folder in which it starts, and {self._folder} contains files that it "
                    "must not see: change to the folder of the submission"
                )
        self._guard = BoxGuard(Limits())

    def _sees(self, file: Path) -> bool:
        places = (self._folder, *map(Path, SYSTEM), *installation())
        return any(Path(os.path.normpath(file)).is_relative_to(place) for place in places)

    def enter(self) -> None:
        """Leave the host's network for one that has only a loopback interface. The process must have no other threads.

        Raises:
            OSError: The system does not allow such namespaces.
        """
        syscalls.leave_the_host()
        syscalls.bring_loopback_up()
        furnish(self._scratch, SCRATCH_BYTES, SCRATCH_INODES)

    def start_of(self, command: Sequence[str], environment: Mapping[str, str]) -> tuple[list[str], list[int]]:
        """Return the command line that starts a command in a box, and its descriptors, which the caller has to close.

        Args:
            command: The command.
            environment: The command's environment outside a box. Variables that Python and ROS need are kept.
        """
        words = box_arguments(self._scratch, [Bind(self._folder)])
        python = {name: value for name, value in environment.items() if name in _OF_PYTHON}
        for name, value in box_environment(python, environment).items():
            words += ["--setenv", name, value]
        words += ["--chdir", str(self._folder)]
        begin, descriptors = bubblewrap(words, hidden_memory=self._guard.hidden_memory)
        return [*begin, *command], descriptors

    def limit(self) -> None:
        """Apply the limits of the box. Call this in the child, before the command is executed."""
        take_limits(self._guard.cgroups, self._guard.rlimits)

    def close(self) -> None:
        """Remove the cgroups. Call this after every command has ended."""
        self._guard.close()
