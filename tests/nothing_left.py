"""Runs a program and, once it has ended, ends all that it has started: ``python -m tests.nothing_left COMMAND...``.

A test's own tidying up does not run where its process is killed. This process adopts whatever loses its parent,
in whatever session it is. It ends the program when it is asked to (SIGTERM), or when who started it dies;
Ctrl-C reaches the program itself. The exit code is the program's.

Temporary files are in a folder of this run, which is removed with all that was left in it. Only pytest's own folders
of the last three runs stay where they always are: with them one finds out why a test failed.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
from typing import TYPE_CHECKING

import psutil

from autograder.process_trees import adopt_orphans, die_with_parent, end_below
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def main(*command: str) -> int:
    """The exit code of the program; as of a shell where a signal has ended it."""
    adopt_orphans()
    os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", tempfile.gettempdir())
    with HeldFolder("course-tests-") as folder:
        code = _exit_code(command, {**os.environ, "TMPDIR": str(folder.path)})
        end_all()
    return code if code >= 0 else 128 - code


def _exit_code(command: Sequence[str], environment: Mapping[str, str]) -> int:
    process = subprocess.Popen(command, env=environment, preexec_fn=_as_from_a_terminal)
    signal.signal(signal.SIGINT, lambda *_: None)
    signal.signal(signal.SIGTERM, lambda *_: _kill(process.pid))
    die_with_parent(number=signal.SIGTERM)
    ended, status = os.wait()
    while ended != process.pid:  # an orphan
        ended, status = os.wait()
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode


def below() -> dict[int, str]:
    """The command line of each process below this one that lives."""
    found = {}
    for process in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            if process.status() != psutil.STATUS_ZOMBIE:
                found[process.pid] = " ".join(process.cmdline())
    return found


def end_all() -> None:
    """Kill the processes below this one, and those that they start meanwhile, until there is none."""
    end_below(os.getpid())


def _kill(pid: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def _as_from_a_terminal() -> None:
    """A shell without job control has what is in its background ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    die_with_parent()


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
