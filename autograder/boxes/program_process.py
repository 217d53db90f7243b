"""A fork of the fork server: `ros2 run`, and the student's program that it starts, both of them warm.

Most of a program's start is imports that all programs have in common. So this process, forked from one that has made
them, is the course's own `ros2` (``environment.ros2_command``), with its look-up and its messages, and exchanges one
thing alone: a Python script for this interpreter becomes a further fork instead of a new process. That fork has the
arguments, the path, the standard streams, the ``__main__`` and the end of a process of its own.

Everything else is started as `ros2 run` starts it: another interpreter's script, a program in another language, and
a script that would import a module of its own where one of the same name has been imported here.
"""

from __future__ import annotations

import builtins
import ctypes
import faulthandler
import importlib
import io
import os
import signal
import subprocess
import sys
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn

from autograder.boxes.preloading import INTERFACES, RCLPY, preload, preload_ros
from environment.ros2_command import main as ros2
from environment.ros2_command import run as ros2_run

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_OF_SCRIPTS = ("environment.ros2_command.pkg", "ament_index_python.packages", "importlib.metadata", "re")
"""Imported by `ros2 run`, and by the scripts that setuptools makes."""
_AT_START = ("sitecustomize", "usercustomize")
"""The modules that Python imports by itself when it starts (the documentation of ``site``)."""
_UNBUFFERED = 2
"""``_IONBF`` of stdio.h."""
_HEAD = 1024
"""Bytes of a script in which its first line ends."""


def prepare() -> None:
    """Import what nearly every program with a node does."""
    _never_unload()
    preload((*RCLPY, *_OF_SCRIPTS))
    preload_ros(INTERFACES)


def _never_unload() -> None:
    """Let this process and its forks end before shared libraries are unloaded, the last thing that ``exit`` does.

    LTTng, which rclpy loads, would end two threads there that a fork has not got, and crash (``lttng_ust_exit``).
    Handlers run in the reverse of this order (atexit(3)), so what is imported from here on is cleaned up as ever.
    """
    libc = ctypes.CDLL(None)
    libc.on_exit(libc._exit, None)
    libc.__cxa_atexit(libc.fflush, None, None)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Be `ros2 run` until its program has ended.

    Args:
        call: ``words``, what follows `ros2` on the command line; ``path``, the ``PYTHONPATH`` of the fork server.
        descriptors: Where standard output and standard error go.

    Raises:
        SystemExit: With the exit code of `ros2`.
    """
    (output,) = descriptors
    for standard in (1, 2):
        os.dup2(output, standard)
    os.close(output)
    sys.argv = ["ros2", *call["words"]]
    given = call["path"].split(os.pathsep)
    ros2_run.start = lambda command: _start(command, given)
    sys.exit(ros2.main())


def _start(command: Sequence[str], given: Sequence[str]) -> ros2_run.Process:
    """Start a program: as a fork where that makes no difference to it.

    Args:
        command: The program and its arguments.
        given: The folders of ``PYTHONPATH`` from which this process has imported.
    """
    own = [folder for folder in _python_path() if folder not in given]
    is_ours = _head(Path(command[0])).split(b"\n")[0] == f"#!{sys.executable}".encode()
    if not is_ours or _names_in([*own, str(Path(command[0]).parent)]) & {*_imported(), *_AT_START}:
        return subprocess.Popen(command)
    return _Fork(command, [folder for folder in sys.path if folder not in given])


def _python_path() -> list[str]:
    return [folder for folder in os.environ.get("PYTHONPATH", "").split(os.pathsep) if folder]


def _head(script: Path) -> bytes:
    with script.open("rb") as file:
        return file.read(_HEAD)


def _imported() -> set[str]:
    return {name.partition(".")[0] for name in sys.modules}


def _names_in(folders: Sequence[str]) -> set[str]:
    """The names that could be imported from these folders, and some that could not."""
    return {
        entry.name.partition(".")[0]
        for folder in map(Path, folders)
        if folder.is_dir()
        for entry in folder.iterdir()
    }


class _Fork:
    """A program that was forked; implements what `ros2 run` uses of :class:`subprocess.Popen`."""

    def __init__(self, command: Sequence[str], standard_path: Sequence[str]) -> None:
        # Python ends by SIGINT after an uncaught KeyboardInterrupt, but only once it has cleaned up, when none of its
        # code runs any more (Py_RunMain in Modules/main.c). So the fork tells it here, and its exit code is made here.
        self._interrupted, tell = os.pipe()
        self._code: int | None = None
        # Ctrl-C waits until the fork has Python's own handler for it.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        self._pid = os.fork()
        if self._pid == 0:
            os.close(self._interrupted)
            _be(command, standard_path, tell)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        os.close(tell)

    def send_signal(self, number: int) -> None:
        """Send it a signal, if it has not ended."""
        if self._code is None:
            os.kill(self._pid, number)

    def wait(self) -> int:
        """Wait for its end; its exit code, negative for a signal."""
        if self._code is None:
            _, status = os.waitpid(self._pid, 0)
            self._code = os.waitstatus_to_exitcode(status)
            os.set_blocking(self._interrupted, False)
            if self._code == 1 and _has_told(self._interrupted):
                self._code = -signal.SIGINT
        return self._code


def _has_told(pipe: int) -> bool:
    try:
        return bool(os.read(pipe, 1))
    except BlockingIOError:  # something that it has started holds the other end
        return False


def _be(command: Sequence[str], standard_path: Sequence[str], interrupted: int) -> NoReturn:
    """Be the process of a Python script, to the end of its interpreter."""
    script, *_ = command
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if os.environ.get("PYTHONFAULTHANDLER"):
        faulthandler.enable(file=2)
    sys.argv = list(command)
    sys.path[:] = [str(Path(script).resolve().parent), *_python_path(), *standard_path]
    importlib.invalidate_caches()
    _open_standard_streams()
    sys.excepthook = sys.__excepthook__
    ctypes.pythonapi.Py_Exit(_exit_code(script, interrupted))
    raise AssertionError("Py_Exit does not return")


def _open_standard_streams() -> None:
    """Open the streams as Python does at its start (config_init_stdio, create_stdio in Python/pylifecycle.c)."""
    at_once = bool(os.environ.get("PYTHONUNBUFFERED"))
    if at_once:  # also the lines of ROS's log, which are written in C
        libc = ctypes.CDLL(None)
        libc.setvbuf(ctypes.c_void_p.in_dll(libc, "stdout"), None, _UNBUFFERED, ctypes.c_size_t(0))
    for name, number, errors in (("stdout", 1, None), ("stderr", 2, "backslashreplace")):
        old = getattr(sys, f"__{name}__")
        raw = open(number, "wb", buffering=0 if at_once else -1, closefd=False)  # noqa: SIM115
        stream = io.TextIOWrapper(
            raw,
            encoding=old.encoding,
            errors=errors or old.errors,
            line_buffering=number == 2 and not at_once,
            write_through=at_once,
        )
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def _exit_code(script: str, interrupted: int) -> int:
    """Run the script as ``__main__``, say what ended it, and return the exit code that Python would end with."""
    main = ModuleType("__main__")
    main.__dict__.update(
        __file__=script,
        __builtins__=builtins,
        __annotations__={},
        __cached__=None,
        __loader__=SourceFileLoader("__main__", script),
    )
    sys.modules["__main__"] = main
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        exec(compile(Path(script).read_bytes(), script, "exec", dont_inherit=True), main.__dict__)
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    except BaseException as error:
        trace = error.__traceback__.tb_next if error.__traceback__ else None  # without this function
        sys.excepthook(type(error), error.with_traceback(trace), trace)
        if isinstance(error, KeyboardInterrupt):
            os.write(interrupted, b"i")
        return 1
    return 0
