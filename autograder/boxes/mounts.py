"""The files that a box sees, as bubblewrap's arguments.

Only what Python, ROS and a build of a workspace need, all of it read-only: the system's programs and libraries, the
Python installation, the environment with the course's packages, and the package itself. Nothing of ``solutions/``,
of a class or of the home folder, though an installation may be below one. All that can be written to is the
scratch, which has a limit and vanishes with the box.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

_PACKAGE = Path(__file__).resolve().parents[1]
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")
_ETC_OF_THE_HOST = ("ld.so.cache", "ld.so.conf", "localtime", "timezone", "protocols", "services")
ETC_FOLDERS = ("alternatives", "ld.so.conf.d")
_SEARCH_PATHS = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "PATH")

USER = "student"
"""The user in a box; the id is that of the first user on many systems."""
USER_ID = 1000
HOME = Path("/home") / USER
WORK = HOME / "notebook"
"""The folder of a notebook, its files and what it writes."""

_PROC_HIDDEN = {"kcore", "kmsg", "keys", "key-users"}
"""Files that say more about the machine and its users than a program needs to know."""

ETC = "etc"
"""The folder of the scratch that no box can write to."""
TERMINALS = "pts"
"""The folder of the scratch with the pseudo-terminals of all boxes of a supervisor."""
_ETC_FILES = {
    "passwd": f"{USER}:x:{USER_ID}:{USER_ID}::{HOME}:/bin/sh\n",
    "group": f"{USER}:x:{USER_ID}:\n",
    "hosts": "127.0.0.1 localhost box\n",
    "nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
}


@dataclass(frozen=True)
class Bind:
    """Something of the host that is to be seen in a box, which may only read it.

    Attributes:
        source: Where it is.
        place: Where the box sees it; at the same path where it is None.
    """

    source: Path
    place: Path | None = None

    def arguments(self) -> list[str]:
        """As arguments of bubblewrap."""
        return ["--ro-bind", str(self.source), str(self.place or self.source)]


@dataclass(frozen=True)
class Link:
    """A symbolic link of the box's own.

    Attributes:
        place: Where it is.
        target: What it leads to in the box.
    """

    place: Path
    target: Path

    def arguments(self) -> list[str]:
        """As arguments of bubblewrap."""
        return ["--symlink", str(self.target), str(self.place)]


def box_arguments(scratch: Path, binds: Sequence[Bind | Link], *, scratch_visible: bool = True) -> list[str]:
    """The arguments of bubblewrap for a box.

    Args:
        scratch: The supervisor's file system in memory.
        binds: What is to be seen beside the system, Python and the course's package.
        scratch_visible: Give the box the scratch as its home, its ``/tmp`` and its ``/dev/shm``. Else it has small
            ones of its own.
    """
    words = [
        "--unshare-user", "--unshare-pid", "--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try",
        "--uid", str(USER_ID), "--gid", str(USER_ID), "--hostname", "box",
        "--cap-drop", "ALL", "--die-with-parent", "--clearenv",
    ]  # fmt: skip
    words += _system()
    words += _etc(scratch)
    words += [
        "--proc",
        "/proc",
        *_proc_covers(),
        "--dev",
        "/dev",
        "--dev-bind",
        str(scratch / TERMINALS),
        "/dev/pts",
    ]
    if scratch_visible:
        for name, place in (("home", HOME), ("work", WORK), ("tmp", Path("/tmp")), ("shm", Path("/dev/shm"))):
            words += ["--bind", str(scratch / name), str(place)]
    else:
        for place in (HOME, Path("/tmp"), Path("/dev/shm")):
            words += ["--size", "64000000", "--tmpfs", str(place)]
    cover = _course_below_the_scratch()
    words += [word for folder in cover for word in ("--tmpfs", folder)]
    for bind in (*(Bind(path) for path in installation()), *binds):
        words += bind.arguments()
    # What bubblewrap itself put there is a file system in memory without a limit.
    return [*words, *(word for folder in ("/dev", "/", *cover) for word in ("--remount-ro", folder))]


def _course_below_the_scratch() -> tuple[str, ...]:
    """Return the folder of the clone if it is below ``/tmp``: Python searches it, and a box could write there.

    The folder of an installed package is a part of Python's own, which the box sees read-only.
    """
    folder = _PACKAGE.parent
    if folder.is_relative_to(sys.prefix) or not any(map(folder.is_relative_to, (HOME, Path("/tmp")))):
        return ()
    return (str(folder),)


def _etc(scratch: Path) -> list[str]:
    """The ``/etc`` of a box, which the supervisor has written, with two folders of the host in it."""
    words = ["--ro-bind", str(scratch / ETC), "/etc"]
    for name in ETC_FOLDERS:
        words += ["--ro-bind-try", f"/etc/{name}", f"/etc/{name}"]
    return words


@functools.cache
def etc_files() -> Mapping[str, bytes]:
    """The ``/etc`` of a box: a user, a host, the linker's and the clock's files, no name service."""
    files = {name: text.encode() for name, text in _ETC_FILES.items()}
    for name in _ETC_OF_THE_HOST:
        with contextlib.suppress(OSError):
            files[name] = Path("/etc", name).read_bytes()
    return files


@functools.cache
def _proc_covers() -> tuple[str, ...]:
    """Cover what in ``/proc`` belongs to the whole machine and can be written to by its owner.

    Where the grader is root, so is the owner of a box's files to the kernel, and in a fresh ``/proc`` root may write to
    settings of the machine (``/proc/sys``), capability or not.
    """
    words: list[str] = []
    for path in sorted(Path("/proc").iterdir()):
        if path.name.isdecimal() or path.is_symlink():
            continue
        if path.is_dir():
            # bubblewrap reads the list of mounts anew for each one: no more of them than needed.
            words += ["--ro-bind", str(path), str(path)] if _can_be_written_below(path) else []
        elif path.name in _PROC_HIDDEN or path.stat().st_mode & 0o222:
            words += ["--ro-bind", "/dev/null", str(path)]
    return tuple(words)


def _can_be_written_below(folder: Path) -> bool:
    return any(
        Path(place, name).lstat().st_mode & 0o222
        for place, _, names in os.walk(folder)
        for name in names
        if not Path(place, name).is_symlink()
    )


def _system() -> list[str]:
    words: list[str] = []
    for name in SYSTEM:
        path = Path(name)
        if path.is_symlink():
            words += ["--symlink", str(path.readlink()), name]
        elif path.is_dir():
            words += ["--ro-bind", name, name]
    return words


@functools.cache
def installation() -> tuple[Path, ...]:
    """The folders of Python, of ROS and of the course's package that lie outside of the system's own.

    An environment has its own prefix and that of the Python it was made with; a sourced ROS has what its search
    paths name. Of a search path only what is an installation is taken: a folder below the prefix of ROS
    (``share/ament_index``) or of conda.
    """
    return _installation(os.environ)


def _installation(variables: Mapping[str, str]) -> tuple[Path, ...]:
    wanted = {Path(sys.prefix), Path(sys.base_prefix), Path(sys.base_prefix).resolve(), _PACKAGE}
    helper = _PACKAGE.parent / "environment"
    if (helper / "ros2_command").is_dir():
        wanted.add(helper)
    for name in _SEARCH_PATHS:
        for entry in variables.get(name, "").split(os.pathsep):
            prefix = _ros_prefix(Path(entry)) if entry.startswith("/") else None
            if prefix is not None:
                wanted.add(prefix)
    return tuple(_outermost(path for path in wanted if path.is_dir() and not _in_system(path)))


def _ros_prefix(path: Path) -> Path | None:
    """The folder of an installation of ROS that a path is in."""
    for folder in (path, *path.parents):
        if (folder / "share" / "ament_index").is_dir() or (folder / "conda-meta").is_dir():
            return folder
    return None


def _in_system(path: Path) -> bool:
    return any(path.is_relative_to(folder) for folder in SYSTEM)


def _outermost(paths: Iterable[Path]) -> list[Path]:
    """The folders without those that are in another of them."""
    every = sorted(set(paths))
    return [
        path for path in every if not any(path != other and path.is_relative_to(other) for other in every)
    ]
