"""A box for a command that somebody runs by hand: what a class gives to a program, without a class around it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.boxes import syscalls
from autograder.boxes.entering import take_limits
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
    """A network of this process's own, and a box on it for each start of a command.

    Args:
        scratch: An empty folder; what is made in it is seen by this process and the boxes alone.
        folder: What a command sees of the user's files, read-only and at its own place. It starts there.
        command: The command, for a look whether it names a file that it would not see.

    Raises:
        ValueError: The folder holds what no box may see, or the command needs more than that. The message says what
            to do.
    """

    def __init__(self, scratch: Path, folder: Path, command: Sequence[str]) -> None:
        self._scratch, self._folder = scratch, folder.resolve()
        for word in command:
            file = self._folder / word
            if os.sep in word and file.exists() and not self._sees(file):
                raise ValueError(
                    f"in a box a command sees the folder it starts in, and {word} is not in {self._folder}: "
                    "go to the folder of what was handed in, and name it from there"
                )
        for kept in (Path.home(), Path(__file__).resolve().parents[2]):
            if kept.resolve().is_relative_to(self._folder):
                raise ValueError(
                    f"in a box a command sees the folder it starts in, and {self._folder} holds too much for that: "
                    "go to the folder of what was handed in"
                )
        self._guard = BoxGuard(Limits())

    def _sees(self, file: Path) -> bool:
        places = (self._folder, *map(Path, SYSTEM), *installation())
        return any(Path(os.path.normpath(file)).is_relative_to(place) for place in places)

    def enter(self) -> None:
        """Leave the host's network for one with nothing but a loopback interface. For a process without threads.

        Raises:
            OSError: There are no such namespaces here.
        """
        syscalls.leave_the_host()
        syscalls.bring_loopback_up()
        furnish(self._scratch, SCRATCH_BYTES, SCRATCH_INODES)

    def start_of(self, command: Sequence[str], environment: Mapping[str, str]) -> tuple[list[str], list[int]]:
        """The command to start in place of another, and the descriptors to start it with, which the caller closes.

        Args:
            command: The command.
            environment: What it would have without a box; what Python and ROS need of it is kept.
        """
        words = box_arguments(self._scratch, [Bind(self._folder)])
        python = {name: value for name, value in environment.items() if name in _OF_PYTHON}
        for name, value in box_environment(python, environment).items():
            words += ["--setenv", name, value]
        words += ["--chdir", str(self._folder)]
        begin, descriptors = bubblewrap(words, hidden_memory=self._guard.hidden_memory)
        return [*begin, *command], descriptors

    def limit(self) -> None:
        """Take the limits of a box; for the process that becomes the command's."""
        take_limits(self._guard.cgroups, self._guard.rlimits)

    def close(self) -> None:
        """Take away what is left once every command has ended."""
        self._guard.close()
