"""Control groups (cgroups) for submissions, if the host allows them: exact counts, and equal shares of processors.

Version 1 (one hierarchy for each controller) and version 2 (one for all) are both supported, because hosts use both.
Whether a process can be put into a new group depends on permissions, delegation and read-only mounts together, so it is
tried with a real process. For the files, see cgroups(7), and ``cgroup-v1/memory`` and ``cgroup-v2`` in the kernel's
documentation.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_KINDS = ("memory", "pids", "cpu", "cpuacct")
"""The controllers that are used. Version 2 has no ``cpuacct``, because each of its groups counts processor time."""
_PREFIX = "autograder-"
_SURELY_LEFT = 60.0
"""The age in seconds above which an empty group of a grader that has ended is removed."""
_numbers = itertools.count()


@dataclass(frozen=True)
class Controller:
    """A cgroup controller for which groups can be made.

    Attributes:
        base: The folder in which creating a folder creates a group.
        version: 1 or 2.
    """

    base: Path
    version: int


class Group:
    """The cgroups of one submission. Each submission gets the same share of the processors.

    Args:
        memory_bytes: The memory limit in bytes for all processes of the submission together, including files in memory.
        processes: The maximum number of processes and threads.
        controllers: The controllers for which groups can be made; None to detect them.
    """

    def __init__(
        self, memory_bytes: int, processes: int, controllers: Mapping[str, Controller] | None = None
    ) -> None:
        self._controllers = usable() if controllers is None else controllers
        name = f"{_PREFIX}{os.getpid()}-{next(_numbers)}"
        self._folders: dict[str, Path] = {}
        for kind, controller in self._controllers.items():
            folder = controller.base / name
            folder.mkdir(exist_ok=True)
            self._folders[kind] = folder
            for file, value in _settings(kind, controller.version, memory_bytes, processes):
                _write(folder / file, value)

    @property
    def procs(self) -> list[str]:
        """The files into which a process writes 0 to join the groups, together with everything that it starts later."""
        return sorted({str(folder / "cgroup.procs") for folder in self._folders.values()})

    @property
    def ran_out_of_memory(self) -> bool:
        """True if the kernel killed a process of the group because the group used too much memory."""
        return self._counted("memory", "memory.oom_control", "memory.events", "oom_kill")

    @property
    def ran_out_of_processes(self) -> bool:
        """True if a process of the group was not allowed another process or thread."""
        return self._counted("pids", "pids.events", "pids.events", "max")

    @property
    def cpu_seconds(self) -> float | None:
        """The processor time, in seconds, of every process that was ever in the group; None if it is not counted."""
        with contextlib.suppress(OSError, ValueError, IndexError):
            if "cpuacct" in self._folders:
                return int((self._folders["cpuacct"] / "cpuacct.usage").read_text()) / 1e9
            for kind, folder in self._folders.items():
                if self._controllers[kind].version == 2:
                    # The first line contains usage_usec.
                    return int((folder / "cpu.stat").read_text().split()[1]) / 1e6
        return None

    def close(self) -> None:
        """Remove the groups, once no process is in them. This may be called twice."""
        for folder in set(self._folders.values()):
            with contextlib.suppress(OSError):
                folder.rmdir()
        self._folders.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _counted(self, kind: str, file_1: str, file_2: str, word: str) -> bool:
        folder = self._folders.get(kind)
        if folder is None:
            return False
        file = file_1 if self._controllers[kind].version == 1 else file_2
        with contextlib.suppress(OSError):
            for line in (folder / file).read_text().splitlines():
                name, _, number = line.partition(" ")
                if name == word:
                    return int(number) > 0
        return False


def memberships(procs: Iterable[str]) -> list[int]:
    """Open the files in :attr:`Group.procs` while their paths are visible, for later use by :func:`join`."""
    return [os.open(file, os.O_WRONLY | os.O_CLOEXEC) for file in procs]


def join(opened: Iterable[int]) -> None:
    """Move this process, and so everything that it starts later, into the groups, and close the descriptors."""
    for group in opened:
        os.write(group, b"0")  # the 0 stands for the process that writes (cgroups(7))
        os.close(group)


@functools.cache
def usable() -> Mapping[str, Controller]:
    """Return the controllers in ``_KINDS`` for which groups can be made here.

    This function also removes groups that a killed grader left behind.
    """
    found = {}
    for kind in _KINDS:
        for controller in _candidates(kind, _text("/proc/self/cgroup"), _text("/proc/self/mountinfo")):
            _sweep(controller.base)
            if _can_hold_a_process(kind, controller):
                found[kind] = controller
                break
    return found


def guards() -> Mapping[str, str]:
    """Return, for each limit, how this host enforces the limit. ``autograder doctor`` shows this."""
    watched = "checked four times a second (no cgroup can be made here)"
    if os.geteuid() == 0:
        of_processes = "; a fork bomb may be faster than the checks: do not grade as root"
    else:
        of_processes = ", and the system limits the number of processes of the box's user"
    return {
        "memory": _cgroup("memory") or watched,
        "processes": _cgroup("pids") or f"{watched}{of_processes}",
        "processor time": "the sum over all processes is checked four times a second; each process has a limit, too",
        "share of the processors": _cgroup("cpu") or "none (no cgroup can be made here)",
        "disk": "a file system in memory that limits the size and the number of files",
        "open files": "each process has a limit, and the sum over all processes is checked four times a second",
    }


def _cgroup(kind: str) -> str:
    controller = usable().get(kind)
    return f"cgroup (version {controller.version})" if controller else ""


def _settings(kind: str, version: int, memory_bytes: int, processes: int) -> Iterable[tuple[str, str]]:
    if kind == "pids":
        return [("pids.max", str(processes))]
    if kind in ("cpu", "cpuacct"):
        # Nothing to set: a new group has the same share as every other one (cpu.shares 1024, cpu.weight 100).
        return []
    if version == 1:
        # If the kernel counts swap, also limit memory and swap together. The kernel requires that this limit is not
        # lower than the limit on memory alone.
        return [
            ("memory.limit_in_bytes", str(memory_bytes)),
            ("memory.memsw.limit_in_bytes", str(memory_bytes)),
        ]
    return [("memory.max", str(memory_bytes)), ("memory.swap.max", "0")]


def _write(file: Path, value: str) -> None:
    # The file that limits swap is missing if the kernel does not count swap. Then there is nothing to limit.
    if file.exists():
        file.write_text(value)


def _candidates(kind: str, own: str, mounts: str) -> list[Controller]:
    """Return the folders in which a group might be made, those nearest to this process's own group first.

    Args:
        kind: The name of the controller.
        own: The content of ``/proc/self/cgroup``.
        mounts: The content of ``/proc/self/mountinfo``.
    """
    paths: dict[str, str] = {}
    for line in own.splitlines():
        _, names, path = line.split(":", 2)
        for name in names.split(","):
            paths[name] = path
    found = []
    for line in mounts.splitlines():
        before, _, after = line.partition(" - ")
        root, place = before.split()[3:5]
        filesystem, _, options = after.split()[:3]
        if filesystem == "cgroup" and kind in options.split(",") and kind in paths:
            found.append(Controller(_inside(place, root, paths[kind]), 1))
        elif filesystem == "cgroup2" and "" in paths and kind in _text(f"{place}/cgroup.controllers").split():
            nearest = _inside(place, root, paths[""])
            # In version 2, a group that contains processes cannot have subgroups with limits, except the topmost
            # group.
            above = [folder for folder in (nearest, *nearest.parents) if folder.is_relative_to(place)]
            found += [Controller(folder, 2) for folder in above]
    return found


def _inside(place: str, root: str, path: str) -> Path:
    """Return the folder of the group ``path``, if the hierarchy's folder ``root`` is mounted at ``place``."""
    inside = os.path.relpath(path, root)
    return Path(place) if inside.startswith("..") else Path(place) / inside


def _can_hold_a_process(kind: str, controller: Controller) -> bool:
    """Return True if a process can be put into a new group with a limit. To find out, try it and undo it."""
    try:
        if controller.version == 2:
            enabled = controller.base / "cgroup.subtree_control"
            if kind not in enabled.read_text().split():
                enabled.write_text(f"+{kind}")
        with Group(1 << 30, 100, {kind: controller}) as group:
            process = subprocess.Popen(["cat"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)
            try:
                for procs in group.procs:
                    Path(procs).write_text(str(process.pid))
            finally:
                process.communicate()
    except (OSError, ValueError):
        return False
    return True


def _sweep(base: Path) -> None:
    """Remove empty groups of graders that have ended."""
    with contextlib.suppress(OSError):
        for folder in base.glob(f"{_PREFIX}*"):
            pid = folder.name.removeprefix(_PREFIX).partition("-")[0]
            # Remove only old ones, because a grader in another PID namespace may be creating a group right now.
            old = time.time() - folder.stat().st_mtime > _SURELY_LEFT
            if pid.isdecimal() and old and not Path(f"/proc/{pid}").exists():
                with contextlib.suppress(OSError):
                    folder.rmdir()


def _text(file: str) -> str:
    try:
        return Path(file).read_text()
    except OSError:
        return ""
