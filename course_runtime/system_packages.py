"""The programs of the operating system that the course needs, and how to install them.

As root on Debian or Ubuntu, a missing package is installed with apt-get. Any other user is told the one command to
type.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import IO, TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

# The purpose of a row: the set-up itself, the tests (tests that need a missing row are skipped), or the sandboxes of
# submissions.
Need = Literal["setup", "tests", "sandbox"]

CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@dataclass(frozen=True)
class SystemPackage:
    """Something that the course needs from the operating system.

    Attributes:
        title: Its name in messages.
        reason: What the course uses it for.
        need: The purpose for which it is needed.
        debian: The packages that contain it on Debian and Ubuntu.
        is_there: Returns True if it exists.
    """

    title: str
    reason: str
    need: Need
    debian: tuple[str, ...]
    is_there: Callable[[], bool]


class MissingPackagesError(Exception):
    """Something that the set-up needs is missing and was not installed. The message says what to type."""


def find_program(*names: str) -> str | None:
    """Return the path of the first of these programs that exists; None if none does."""
    return next((path for name in names if (path := shutil.which(name))), None)


def find_compilers() -> tuple[str, str] | None:
    """Return the C and C++ compilers that CMake will use; None if one of them is missing."""
    c = find_program(*_named_in("CC"), "cc", "gcc", "clang")
    cpp = find_program(*_named_in("CXX"), "c++", "g++", "clang++")
    return (c, cpp) if c and cpp else None


def _named_in(variable: str) -> list[str]:
    return os.environ.get(variable, "").split()[:1]


def _has_headers() -> bool:
    return (Path(sysconfig.get_path("include")) / "Python.h").exists()


TABLE = (
    SystemPackage(
        title="a C and C++ compiler",
        reason="to build the interface package",
        need="setup",
        debian=("gcc", "g++", "libc6-dev"),
        is_there=lambda: find_compilers() is not None,
    ),
    SystemPackage(
        title="the header files of Python",
        reason="to build the interface package",
        need="setup",
        debian=("python3-dev",),
        is_there=_has_headers,
    ),
    SystemPackage(
        title="Python's venv module",
        reason="to make the course's own environment",
        need="setup",
        debian=("python3-venv",),
        is_there=lambda: find_spec("ensurepip") is not None,
    ),
    SystemPackage(
        title="Chromium",
        reason="for the browser test",
        need="tests",
        debian=("chromium",),
        is_there=lambda: find_program(*CHROMIUM_NAMES) is not None,
    ),
    SystemPackage(
        title="bubblewrap",
        reason="to grade a class: it shuts submissions off from everything",
        need="sandbox",
        debian=("bubblewrap",),
        is_there=lambda: find_program("bwrap") is not None,
    ),
)


@dataclass(frozen=True)
class Apt:
    """How packages can be installed here: `program` is apt-get or None, `as_root` is True if this user may run it."""

    program: str | None
    as_root: bool

    @classmethod
    def here(cls) -> Apt:
        """Return how this user can install packages on this machine."""
        return cls(shutil.which("apt-get"), os.geteuid() == 0)


def missing(need: Need, table: Sequence[SystemPackage] = TABLE) -> list[SystemPackage]:
    """Return the rows for one purpose that are missing."""
    return [row for row in table if row.need == need and not row.is_there()]


def get_with(rows: Iterable[SystemPackage], apt: Apt) -> str:
    """Return a line that tells a user how to get the things in these rows: the command to type, if it is known."""
    rows = list(rows)
    if apt.program:
        return "Get it with: sudo apt-get install -y " + " ".join(name for row in rows for name in row.debian)
    return f"Get {', '.join(row.title for row in rows)} with the package manager of your system."


def _apt_install(rows: Sequence[SystemPackage], apt: Apt, log: IO[str]) -> bool:
    """Install the packages of the rows with apt-get. Return True if both of its commands succeeded."""
    environ: Mapping[str, str] = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    names = [name for row in rows for name in row.debian]
    for arguments in (["update"], ["install", "-y", "--no-install-recommends", *names]):
        command = [str(apt.program), *arguments]
        done = subprocess.run(
            command, env=environ, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, check=False
        )
        if done.returncode != 0:
            return False
    return True


def provide(
    need: Need,
    log: IO[str],
    say: Callable[[str], None],
    apt: Apt | None = None,
    table: Sequence[SystemPackage] = TABLE,
) -> list[SystemPackage]:
    """Install what is missing for one purpose if that is possible. Return the rows that are still missing.

    Args:
        need: The purpose.
        log: Receives the output of apt-get.
        say: Prints a line for the user.
        apt: How packages can be installed here; None to find that out.
        table: The rows.
    """
    apt = apt or Apt.here()
    absent = missing(need, table)
    if absent and apt.program and apt.as_root:
        say(f"installing {', '.join(row.title for row in absent)} with apt-get")
        _apt_install(absent, apt, log)
        absent = missing(need, table)
    return absent


def require(need: Need, log: IO[str], say: Callable[[str], None], apt: Apt | None = None) -> None:
    """Like `provide`, but raise an error if something is still missing afterwards.

    Raises:
        MissingPackagesError: Something is missing. The message contains the one command to type.
    """
    apt = apt or Apt.here()
    absent = provide(need, log, say, apt)
    if absent:
        wanted = ", ".join(f"{row.title} ({row.reason})" for row in absent)
        raise MissingPackagesError(f"{wanted} is missing. {get_with(absent, apt)}")
