"""Set the course up in ``.venv``: ``python3 -m environment.bootstrap``, with the options below.

``./course`` calls this, with any Python from 3.11 on and only its standard library. Each step is stamped with a hash
of its inputs (see steps.py), so a second run does only what is left to do: usually nothing.
"""

from __future__ import annotations

import argparse
import fcntl
import os
import shutil
import subprocess
import sys
from collections import deque
from pathlib import Path
from typing import IO, TYPE_CHECKING

from course_runtime import ros_flavour, system_packages
from course_runtime.place import Place, may_write, owner
from course_runtime.python_child import INTERPRETER
from course_runtime.ros_flavour import Machine, NoRosError, Ros
from environment.lock import EXTRAS
from environment.setup_steps import Setup, SetupError
from environment.steps import run_steps

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

ROOT = Path(__file__).resolve().parent.parent
# The disk space of a complete environment, with some reserve for the build, in bytes.
_SPACE_NEEDED = 1_600_000_000
_LOG_LINES_SHOWN = 25
# Earlier versions left these in the set-up's folder; colcon writes all variables of the user into the first two.
_LEFTOVERS = ("build", "colcon-log", "interfaces")
# The maximum length of a line of the log that is shown, in characters. pip names all of its packages in one line.
_LOG_COLUMNS_SHOWN = 200


def say(line: str) -> None:
    """Print a line for the user on standard error, because standard output belongs to the command that follows."""
    print(f"course: {line}", file=sys.stderr, flush=True)


def choose_ros(place: Place, environ: Mapping[str, str]) -> tuple[Ros, dict[str, str]]:
    """Decide which ROS to use. Return it, with the variables in which it is sourced.

    Raises:
        NoRosError: No ROS can be used here.
    """
    sourced = ros_flavour.with_recorded(environ, ros_flavour.load(place.prefix))

    def imports_rclpy() -> bool:
        command = [str(place.base_python), "-c", "import rclpy"]
        return subprocess.run(command, env=sourced, capture_output=True, check=False).returncode == 0

    return ros_flavour.decide(sourced, Machine.here(), imports_rclpy), sourced


def without_network(wheels: Path | None) -> dict[str, str]:
    """Return the variables with which pip, and so uv, installs from a folder of wheels only.

    Raises:
        SetupError: The folder does not exist.
    """
    if wheels is None:
        return {}
    if not wheels.is_dir():
        raise SetupError(
            f"the folder {wheels} does not exist. `python3 -m environment.lock --wheels FOLDER` fills one."
        )
    return {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(wheels.resolve()), "PIP_EXTRA_INDEX_URL": ""}


def _find_base_python() -> Path:
    # If the Python of an environment runs this, the next environment must not be made from it.
    return Path(os.path.realpath(getattr(sys, "_base_executable", INTERPRETER)))


def _check_place(place: Place) -> None:
    """Check for conditions that would make the set-up fail later or do harm.

    Raises:
        SetupError: Such a condition was found.
    """
    if ":" in str(place.root):
        raise SetupError(f"a search path cannot hold a folder with a colon in its name: {place.root}")
    if place.prefix.exists() and not (place.notes.exists() or (place.prefix / "pyvenv.cfg").exists()):
        raise SetupError(f"{place.prefix} exists, but is not a Python environment. Move it away.")
    if not may_write(place.root):
        state = "was changed since it was set up" if place.notes.exists() else "is not set up yet"
        raise SetupError(
            f"the course {state}, and you may not write to its folder. "
            f"Have {owner(place.root)}, whose folder it is, type: {place.root}/course setup"
        )


def _check_space(place: Place) -> None:
    """Raise a SetupError if a new environment does not fit on the disk."""
    free = shutil.disk_usage(place.root).free
    if not (place.notes / "stamps" / "packages").exists() and free < _SPACE_NEEDED:
        raise SetupError(
            f"the disk of {place.root} has {free / 1e9:.1f} GB left, "
            f"the environment needs {_SPACE_NEEDED / 1e9:.1f} GB."
        )


def _explain_failure(log_path: Path) -> None:
    """Show the end of the log, with a sentence about the usual causes."""
    try:
        with log_path.open(encoding="utf-8", errors="replace") as log:
            lines = list(deque(log, _LOG_LINES_SHOWN))
    except OSError:
        return
    text = "".join(lines)
    for line in lines:
        print(f"  | {line.rstrip()[:_LOG_COLUMNS_SHOWN]}", file=sys.stderr)
    if "No space left on device" in text:
        say("the disk is full.")
    elif "HASHES" in text:
        say(
            "a downloaded file is not the one that is locked. A proxy may have changed it: do not install it."
        )
    elif "No matching distribution" in text or "Retrying (" in text:
        say("pip could not fetch a package. Is there a network, and is pip's package index the usual one?")
    say(f"the whole log is {log_path}")


def _extras(place: Place, asked: Sequence[str]) -> list[str]:
    """Return the extras to install. An extra that was requested once stays."""
    noted = place.notes / "extras"
    before = noted.read_text(encoding="utf-8").split() if noted.is_file() else []
    wanted = [name for name in EXTRAS if name in before or name in asked]
    if wanted:
        noted.write_text(" ".join(wanted) + "\n", encoding="utf-8")
    return wanted


def set_up(place: Place, environ: Mapping[str, str], with_tests: bool, extras: Sequence[str] = ()) -> None:
    """Bring the environment up to date.

    Args:
        place: The paths of the environment.
        environ: The environment variables of the user.
        with_tests: True to install what ``./course test`` needs, too.
        extras: The extras of pyproject.toml to install.

    Raises:
        SetupError, NoRosError, MissingPackagesError: The set-up failed. The message says what to do.
    """
    _check_place(place)
    ros, sourced = choose_ros(place, environ)
    if ros.notice:
        say(ros.notice)
    _check_space(place)
    place.notes.mkdir(parents=True, exist_ok=True)
    for name in _LEFTOVERS:
        shutil.rmtree(place.notes / name, ignore_errors=True)
    log_path = place.notes / "setup.log"
    with log_path.open("a", encoding="utf-8") as log:
        log_path.chmod(0o600)  # packages that fail to install may print anything
        system_packages.require("setup", log, say)
        setup = Setup(place, ros, sourced, log, say)
        steps = setup.steps(with_tests, _extras(place, extras))
        try:
            done = run_steps(steps, place.notes / "stamps", place.root, say)
        except SetupError:
            _explain_failure(log_path)
            raise
        setup.compile_modules()
        _provide("sandbox", log, "so a class cannot be graded here; everything else works")
        if with_tests:
            _provide("tests", log, "so what needs it is skipped")
    if done:
        if place.warning:
            say(place.warning)
        say("set up.")


def _provide(need: system_packages.Need, log: IO[str], otherwise: str) -> None:
    """Install what is missing for a need if that is possible; else print the consequence and the command to type."""
    apt = system_packages.Apt.here()
    for row in system_packages.provide(need, log, say, apt):
        get = system_packages.get_with([row], apt)
        say(f"{row.title} is not there ({row.reason}), {otherwise}. {get}")


def main(arguments: list[str] | None = None) -> int:
    """Set up, one set-up at a time, and record the token of `./course` when everything is done."""
    parser = argparse.ArgumentParser(
        prog="python3 -m environment.bootstrap", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--tests", action="store_true", help="also what ./course test needs")
    parser.add_argument(
        "--with", dest="extras", action="append", choices=EXTRAS, default=[], help="also what this needs"
    )
    parser.add_argument(
        "--wheels",
        type=Path,
        help="install from this folder, without a network; environment/lock.py fills it",
    )
    parser.add_argument("--token", help="what ./course compares to know that nothing changed since")
    options = parser.parse_args(arguments)
    place = Place(ROOT, _find_base_python())
    # A lock on a folder: it leaves no file behind, and ends with this process.
    folder = os.open(place.locked, os.O_RDONLY)
    try:
        try:
            fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("another set-up is running, waiting for it")
            fcntl.flock(folder, fcntl.LOCK_EX)
        set_up(place, {**os.environ, **without_network(options.wheels)}, options.tests, options.extras)
        if options.token:
            (place.notes / "token").write_text(f"{options.token}\n", encoding="utf-8")
    except (SetupError, NoRosError, system_packages.MissingPackagesError) as error:
        say(f"error: {error}")
        return 2
    except OSError as error:
        say(f"error: {error.strerror}: {error.filename or place.prefix}")
        return 2
    except KeyboardInterrupt:
        say("interrupted. Type the same command again: the set-up continues from there.")
        return 130
    finally:
        os.close(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
