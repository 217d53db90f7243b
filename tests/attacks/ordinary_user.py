"""Run a command as a user without any right of root's: python tests/attacks/ordinary_user.py COMMAND…

Needs root. The user is a number that this machine need not know, has no capability, and as many open files as a login
gets. Where Python or the repository lies in a folder that only its owner may enter, such as root's home, the user sees
that folder with nothing else in it; everybody else sees it as it is.
"""

from __future__ import annotations

import ctypes
import os
import resource
import sys
from pathlib import Path

from autograder import course
from autograder.boxes.process_isolation import unshare
from autograder.boxes.seccomp_filter import CLONE_NEWNS

USER = 64_123
OPEN_FILES = 1024
"""What a login mostly gets as its soft limit."""
_REC, _PRIVATE, _BIND = 0x4000, 1 << 18, 0x1000


def main() -> None:
    """Become the user, then the command."""
    unshare(CLONE_NEWNS)
    _mount("none", Path("/"), _REC | _PRIVATE)
    for needed in (Path(sys.base_prefix).resolve(), Path(sys.prefix), course.root()):
        _open_the_way(needed)
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (OPEN_FILES, hard))
    os.setgroups([])
    os.setresgid(USER, USER, USER)
    os.setresuid(USER, USER, USER)  # takes every capability along (capabilities(7))
    os.execvp(sys.argv[1], sys.argv[1:])


def _open_the_way(needed: Path) -> None:
    closed = next((folder for folder in reversed(needed.parents) if not folder.stat().st_mode & 0o001), None)
    if closed is None:
        return
    descriptor = os.open(needed, os.O_PATH)
    _mount("tmpfs", closed, 0, "mode=755")
    needed.mkdir(parents=True)
    _mount(f"/proc/self/fd/{descriptor}", needed, _BIND | _REC)
    os.close(descriptor)


def _mount(source: str, place: Path, flags: int, options: str = "") -> None:
    # mount(8) would look up the path behind the descriptor anew.
    libc = ctypes.CDLL(None, use_errno=True)
    kind = None if flags else b"tmpfs"
    if libc.mount(source.encode(), os.fsencode(place), kind, ctypes.c_ulong(flags), options.encode()) < 0:
        raise OSError(ctypes.get_errno(), f"mount {place}")


if __name__ == "__main__":
    main()
