"""The part of the host that a box sees: files, as arguments for bubblewrap, and environment variables.

A box sees only what Python, ROS and the build of a workspace need, read-only: the system's programs and libraries, the
Python installation, the environment with the course's packages, and this package. It sees no ``solutions/``, no class
and no home folder, even if an installation lies inside one. It can write only to the scratch, a file system in memory
that has a size limit and disappears with the box. Of the environment variables, a box gets only those that Python and
ROS need.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_runtime import ros_flavour
from course_runtime.python_child import SEARCH_PATHS, listed_environment

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

_PACKAGE = Path(__file__).resolve().parents[1]
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")

USER = "student"
"""The name of the user in a box. The user's id is 1000, as for the first user on many systems."""
USER_ID = 1000
HOME = Path("/home") / USER
WORK = HOME / "notebook"
"""The folder that contains the notebook's files: those next to the notebook, and those that the notebook writes."""

ETC = "etc"
"""The folder of the scratch that becomes the ``/etc`` of a box, to which no box can write."""
ETC_FOLDERS = ("alternatives", "ld.so.conf.d")
"""The folders of the host's ``/etc`` that every box sees."""
TERMINALS = "pts"
"""The folder of the scratch that contains the pseudo-terminals of all boxes of a supervisor."""


@dataclass(frozen=True)
class Bind:
    """A file or folder of the host that a box can see, but only read.

    Attributes:
        source: The path on the host.
        place: The path in the box; None for the same path as on the host.
    """

    source: Path
    place: Path | None = None

    def arguments(self) -> list[str]:
        """Return the arguments for bubblewrap."""
        return ["--ro-bind", str(self.source), str(self.place or self.source)]


@dataclass(frozen=True)
class SymbolicLink:
    """A symbolic link that exists only in the box.

    Attributes:
        place: The path of the link.
        target: The path, in the box, to which the link leads.
    """

    place: Path
    target: Path

    def arguments(self) -> list[str]:
        """Return the arguments for bubblewrap."""
        return ["--symlink", str(self.target), str(self.place)]


def box_arguments(
    scratch: Path, binds: Sequence[Bind | SymbolicLink], *, scratch_visible: bool = True
) -> list[str]:
    """Return the arguments with which bubblewrap makes a box.

    Args:
        scratch: The supervisor's file system in memory.
        binds: What the box sees in addition to the system, Python and this package.
        scratch_visible: True if the box's home, ``/tmp`` and ``/dev/shm`` are folders of the scratch. If False, they
            are small file systems of this box alone.
    """
    words = [
        "--unshare-user", "--unshare-pid", "--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try",
        "--uid", str(USER_ID), "--gid", str(USER_ID), "--hostname", "box",
        "--cap-drop", "ALL", "--die-with-parent", "--clearenv",
    ]  # fmt: skip
    words += _system()
    words += ["--ro-bind", str(scratch / ETC), "/etc"]
    for name in ETC_FOLDERS:
        words += ["--ro-bind-try", f"/etc/{name}", f"/etc/{name}"]
    words += ["--proc", "/proc", *_proc_covers()]
    words += ["--dev", "/dev", "--dev-bind", str(scratch / TERMINALS), "/dev/pts"]
    if scratch_visible:
        for name, place in (("home", HOME), ("work", WORK), ("tmp", Path("/tmp")), ("shm", Path("/dev/shm"))):
            words += ["--bind", str(scratch / name), str(place)]
    else:
        for place in (HOME, Path("/tmp"), Path("/dev/shm")):
            words += ["--size", "64000000", "--tmpfs", str(place)]
    cover = _below_the_scratch()
    words += [word for folder in cover for word in ("--tmpfs", folder)]
    for bind in (*(Bind(path) for path in installation()), *binds):
        words += bind.arguments()
    # The other folders that bubblewrap makes are file systems in memory without a size limit, so they are made
    # read-only.
    return [*words, *(word for folder in ("/dev", "/", *cover) for word in ("--remount-ro", folder))]


def _below_the_scratch() -> tuple[str, ...]:
    """Return the folders of the course's git clone and of Python if a box could write to them; else nothing.

    A box can write to ``/tmp`` and its home. A clone or an environment in one of these is made read-only, because
    Python imports from it.
    """
    folders = _outermost({_PACKAGE.parent, *_python_prefixes()})
    return tuple(str(folder) for folder in folders if any(map(folder.is_relative_to, (HOME, Path("/tmp")))))


_ETC_FILES = {
    "passwd": f"{USER}:x:{USER_ID}:{USER_ID}::{HOME}:/bin/sh\n",
    "group": f"{USER}:x:{USER_ID}:\n",
    "hosts": "127.0.0.1 localhost box\n",
    "nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
}


@functools.cache
def etc_files() -> Mapping[str, bytes]:
    """Return the files for a box's ``/etc``, by name, such as those with the user, the host and the time zone."""
    files = {name: text.encode() for name, text in _ETC_FILES.items()}
    for name in ("ld.so.cache", "ld.so.conf", "localtime", "timezone", "protocols", "services"):
        with contextlib.suppress(OSError):
            files[name] = Path("/etc", name).read_bytes()
    return files


_PROC_HIDDEN = {"bootconfig", "cmdline", "kmsg", "keys", "key-users", "sched_debug"}
"""Files in ``/proc`` that say more about the machine and its users than a program needs, in addition to those that only
root can read.
"""


@functools.cache
def _proc_covers() -> tuple[str, ...]:
    """Return bubblewrap's arguments that protect the writable files in ``/proc``, which affect the whole machine.

    If the grader is root, a box needs these arguments. The kernel then treats the user of a box as root, too, and root
    may write to the settings in ``/proc/sys`` even without any capability.
    """
    words: list[str] = []
    for path in sorted(Path("/proc").iterdir()):
        if path.name.isdecimal() or path.is_symlink():
            continue
        if path.is_dir():
            # Bind only folders that need it, because bubblewrap reads the list of mounts again for each bind.
            words += ["--ro-bind", str(path), str(path)] if _can_be_written_below(path) else []
        else:
            mode = path.stat().st_mode
            is_roots = not mode & 0o004 and os.access(path, os.R_OK)
            if path.name in _PROC_HIDDEN or mode & 0o222 or is_roots:
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
    """Return the programs and libraries of the system, as arguments for bubblewrap."""
    words: list[str] = []
    for name in SYSTEM:
        path = Path(name)
        if path.is_symlink():
            words += ["--symlink", str(path.readlink()), name]
        elif path.is_dir():
            words += ["--ro-bind", name, name]
    return words


_PARTS = (
    *("bin", "etc/ipython", "include", "lib*", "openssl", "pyvenv.cfg", "share", "ssl", "*-linux-gnu"),
    *("local_setup.bash", "local_setup.sh", "_local_setup_util_sh.py"),  # a built workspace sources them
)
"""The parts of an installation of Python, as patterns, that a box sees: programs, libraries, and what they read.

The rest of such a folder may be private: the records of the set-up, pip's settings, or other environments of conda.
"""
OVERLAYS = "AUTOGRADER_OVERLAYS"
"""The environment variable, a search path, with the workspaces that the class names in ``class.toml``."""


@functools.cache
def installation() -> tuple[Path, ...]:
    """Return the files and folders of Python, ROS, the class's overlays and this package outside the system's folders.

    ROS is what the set-up has recorded, or else what is sourced. A workspace that is sourced on top of ROS is not part
    of it, because it may contain anything, even solutions.
    """
    return _installation(os.environ)


def _installation(variables: Mapping[str, str]) -> tuple[Path, ...]:
    wanted = {_PACKAGE, _PACKAGE.parent / "course_runtime", *_ros_prefixes(variables)}
    for prefix in _python_prefixes():
        wanted.update(path for pattern in _PARTS for path in prefix.glob(pattern))
    return _outermost(path for path in wanted if path.exists() and not any(map(path.is_relative_to, SYSTEM)))


def _outermost(paths: Iterable[Path]) -> tuple[Path, ...]:
    """Return the sorted paths without those inside another one of them."""
    found: list[Path] = []
    for path in sorted(paths):
        if not any(map(path.is_relative_to, found)):
            found.append(path)
    return tuple(found)


def _python_prefixes() -> set[Path]:
    return {Path(sys.prefix), Path(sys.base_prefix), Path(sys.base_prefix).resolve()}


def _ros_prefixes(variables: Mapping[str, str]) -> set[Path]:
    """Return the folders of ROS outside of Python's environment, and of the overlays that the class names."""
    recorded = ros_flavour.load(Path(sys.prefix))
    ros = (
        ros_flavour.sourced_prefixes(variables)
        if recorded is None
        else recorded.paths.get("AMENT_PREFIX_PATH", ())
    )
    overlays = variables.get(OVERLAYS, "").split(os.pathsep)
    return {Path(entry) for entry in (*ros, *overlays) if entry.startswith("/")}


_NO_THREADS = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Variables that keep numpy's libraries from starting threads when they are loaded.

A fork would lose these threads. A program in which ROS imports numpy would then wait in a busy loop for work that
never comes.
"""


def base_environment(given: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return the environment of a fork server and of every box: what Python and ROS need, and nothing else.

    Args:
        given: The environment to take values from; None for the environment of this process.
    """
    own = {"HOME": "/nonexistent", "PYTHONNOUSERSITE": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return {**_kept(os.environ if given is None else given), **_NO_THREADS, **own}


def box_environment(
    extra: Mapping[str, str] | None = None, given: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Return the complete environment of a process in a box.

    Args:
        extra: Variables to set, whatever their values on the host.
        given: The environment to take values from; None for the environment of this process.
    """
    return {
        **base_environment(given),
        "USER": USER,
        **_own_folders(HOME, Path("/tmp"), HOME / ".ros" / "log"),
        **(extra or {}),
    }


def kernel_environment(scratch: Path, extra: Mapping[str, str]) -> dict[str, str]:
    """Return the complete environment of a kernel that has its home, temporary and log folders in ``scratch``.

    Args:
        scratch: An existing folder. The folders inside it are created here.
        extra: Variables to set, whatever their values on the host.
    """
    folders = _own_folders(scratch / "home", scratch / "tmp", scratch / "log")
    for folder in folders.values():
        Path(folder).mkdir(parents=True, exist_ok=True)
    return {
        **_kept(os.environ),
        **folders,
        "PYTHONNOUSERSITE": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
        **extra,
    }


def _own_folders(home: Path, temporary: Path, log: Path) -> dict[str, str]:
    folders = {
        "HOME": home,
        "TMPDIR": temporary,
        "ROS_LOG_DIR": log,
        "IPYTHONDIR": home / ".ipython",
        "JUPYTER_CONFIG_DIR": home / ".jupyter",
    }
    return {name: str(folder) for name, folder in folders.items()}


def _kept(given: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that Python and ROS need. Search paths keep only folders that a box sees."""
    kept = listed_environment(given)
    seen = (*map(Path, SYSTEM), *_python_prefixes(), *_ros_prefixes(given))
    for name in SEARCH_PATHS & kept.keys():
        entries = kept.pop(name).split(os.pathsep)
        if entries := [entry for entry in entries if any(map(Path(entry).is_relative_to, seen))]:
            kept[name] = os.pathsep.join(entries)
    return kept
