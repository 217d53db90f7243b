"""`ros2 run`."""

from __future__ import annotations

import argparse
import shlex
import signal
from typing import TYPE_CHECKING

from course_runtime import program_start
from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.pkg import executable_paths

if TYPE_CHECKING:
    from pathlib import Path
    from types import FrameType


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--prefix",
        help="Prefix command, which should go before the executable. Command must be wrapped in quotes if it "
        "contains spaces (e.g. --prefix 'gdb -ex run --args').",
    )
    parser.add_argument("package_name", help="Name of the ROS package")
    parser.add_argument("executable_name", help="Name of the executable")
    parser.add_argument("argv", nargs=argparse.REMAINDER, help="Pass arbitrary arguments to the executable")


def find_executable(package: str, executable: str) -> Path:
    """Return the program of a package.

    Raises:
        RuntimeError: The package or its program does not exist, or several programs have this name.
    """
    found = [path for path in executable_paths(package) if path.name == executable]
    if not found:
        raise RuntimeError("No executable found")
    if len(found) > 1:
        raise RuntimeError("\n- ".join(["Multiple executables found:", *map(str, found)]))
    return found[0]


def _run(args: argparse.Namespace) -> Outcome:
    program = find_executable(args.package_name, args.executable_name)
    # The terminal also sends Ctrl-C to the program, which ends in its own way. As an exception in this process,
    # Ctrl-C could come just after the program's start or end, before this is recorded.
    signal.signal(signal.SIGINT, lambda *_: None)
    process = program_start.start([*shlex.split(args.prefix or ""), str(program), *args.argv])

    def pass_on(number: int, _frame: FrameType | None) -> None:
        process.send_signal(number)

    # Only this process gets SIGTERM; if it did not pass it on, the program would continue without it.
    signal.signal(signal.SIGTERM, pass_on)
    code = process.wait()
    if code < 0 and -code in signal.valid_signals():
        print(f"[ros2run]: {signal.strsignal(-code)}")
    elif code:
        print(f"[ros2run]: Process exited with failure {code}")
    return code


VERBS = {"run": Verb(_arguments, _run)}
