"""A build as a job: what it is told, what comes of it, and who runs it, here or in a box.

Whatever a build does, it only ever yields bytes: output, and the files that it left in its install folder. Nothing of
it is executed or unpickled by who has asked for it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path


@dataclass(frozen=True)
class BuildJob:
    """A build that is wanted.

    Attributes:
        name: See :meth:`Builder.place`.
        entry: Holds ``src``, which the build may read. All that it writes is gone afterwards, but for ``install`` of
            the place.
        command: Names everything as it is seen from the job.
        variables: More variables of its environment.
        cancelled: Asked now and then; the build is ended when it says so.
        hidden: Files and folders of the environment that the build must not find.
        begun: Told the first process of a build that goes on when this one is killed.
    """

    name: str
    entry: Path
    command: Sequence[str]
    variables: Mapping[str, str]
    cancelled: Callable[[], bool]
    hidden: Sequence[Path]
    begun: Callable[[int], None]


@dataclass(frozen=True)
class Built:
    """How a build ended.

    Attributes:
        returncode: Of colcon; None where it was ended, at a limit or because nobody waits for it any more.
        output: What it said.
        archive: Its install folder as a tar file, made once nothing of the build was alive any more; None where
            it failed, or was made in the entry itself.
        late: The seconds after which it was ended because it took too long, which may be the machine's fault; else 0.
    """

    returncode: int | None
    output: bytes
    archive: bytes | None = field(default=None, repr=False)
    late: float = 0.0


class Builder(Protocol):
    """Runs builds."""

    def place(self, name: str, entry: Path) -> Path:
        """Where jobs see a folder of the cache of builds.

        Args:
            name: What stands for the kind of workspace, such as ``"ros2_ws"``: each has a place of its own.
            entry: The folder.
        """
        ...

    def build(self, job: BuildJob) -> Built:
        """Run colcon."""
        ...
